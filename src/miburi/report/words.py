"""What the page says about each table and figure."""

from __future__ import annotations

TABLES = {
    "table1": (
        "Table 1 of [P]: who finds the motion among the first 10",
        "Of the users of experiment 1, how many have a segment with the keyword among the first 10 (5). Protocol 1: "
        "the clip that was shown is imitated; protocol 2: only the keyword is given. The rows “mean” are computed "
        "from the rows, the paper's too; chance is what a random order would give.",
    ),
    "table2": (
        "Table 2 of [P]: where the shown clip is ranked",
        "Mean rank of the clip that the user saw and imitated, with a 95 % bootstrap interval and the mean rank in "
        "a random order.",
    ),
    "table3": (
        "Table 3 of [P]: the larger database",
        "As table 1, for experiment 2: keywords alone, with and without the histograms of movement (Jvh).",
    ),
    "table4": (
        "Table 4 of [P]: seconds per query, experiment 1",
        "Median over all queries, one core of the machine that made this page; the paper's machine is of 2008.",
    ),
    "differences1": (
        "Measures compared in pairs, experiment 1",
        "Each measure minus DSPM(PCA) for the same queries, with a paired bootstrap interval (95 %) and Wilcoxon's "
        "signed-rank p. Ranks: smaller is better; everything else: larger is better.",
    ),
    "differences2": (
        "Measures compared in pairs, experiment 2",
        "As for experiment 1.",
    ),
    "other_people": (
        "Only other people's clips are ranked",
        "Protocol 3: a user imitates a clip, and all clips of the person shown are left out. Precision at 5 and 10 "
        "and mean average precision, beside the naive measure and chance.",
    ),
    "table5": ("Table 5 of [P]: seconds per query, experiment 2", "As table 4, for the larger database."),
    "puppeteers": (
        "Two puppeteers: our simulated users beside logs of another origin",
        "Where each measure ranks the clip that was imitated: by a puppet log that the project did not make (`rank`), "
        "and by development users of ours who imitate the same clip (`rank_ours`: their mean; lowest and highest). "
        "The means and medians are over all clips. What lies behind disagreements stands in docs/puppeteer.md.",
    ),
    "label_counts": (
        "Table 2 of [H]: frames and intervals of each label",
        "What the label files hold, and how long the string of labels becomes by each way of counting: with an "
        "exit from the last state or without, durations exact or as the product that the paper prints (238 frames).",
    ),
}

CUTS = {
    "segmentation": "cuts against what was annotated",
    "segment_lengths": "how long the segments are",
}

FIGURES = {
    "fig4": (
        "Figure 4 of [H]: the generated curve",
        "The third joint of the middle finger in the generated motion; vertical lines are label boundaries.",
    ),
    "fig5": (
        "Figure 5 of [H]: recordings put end to end",
        "The same labels cut from the recordings: similar, but with steps at the joins.",
    ),
    "staircase": (
        "What the model does",
        "The means of the states as steps with ±σ around them, and the trajectory that is likeliest with the deltas' "
        "Gaussians too.",
    ),
    "fig6": (
        "Figure 6 of [H]: changes",
        "Strips of rendered frames of the changes between the hand's poses.",
    ),
}
