"""What the page says about each table and figure."""

from __future__ import annotations

from collections.abc import Sequence

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

MEASURES = {
    "SM(PCA)": "subspace method: what the principal components of a segment leave of the query's frames; the worst "
    "frame counts",
    "DSPM(PCA)": "the paper's own: as SM, and what the query's components leave of the segment's frames; the larger of "
    "both",
    "SM(GP-LVM), DSPM(GP-LVM)": "the same, with a Gaussian process latent variable model in place of the components",
    "MSM": "mutual subspace method: the angles between the subspaces of query and segment",
    "DTW": "dynamic time warping: frame against frame, along the path in time that fits best",
    "mean pose": "distance of the mean poses alone, which is the least that a measure should beat",
    "… +Jvh": "the measure times the distance of the histograms of how far each joint moves",
}

COLUMNS = {
    "protocol": "1: the clip was shown; 2: only the keyword was given; 3: only other people's clips are ranked",
    "keyword": "what was to be played; “mean” is over all of them",
    "against": "the measure that this one is compared with",
    "figure": "what is compared: whether the keyword is among the first 10 or 5 (hit10, hit5), the rank of the shown "
    "clip (rank) and of the first clip with the keyword (first), precision",
    "value": "the figure's mean over queries",
    "value_against": "the same of the measure that it is compared with",
    "difference": "the former minus the latter",
    "wilcoxon_p": "p of Wilcoxon's signed-rank test",
    "paired_queries": "queries that both measures answered",
    "hit10": "users who have the keyword among the first 10",
    "hit5": "users who have the keyword among the first 5",
    "users": "users that there are",
    "chance10": "hit10 in a random order",
    "chance5": "hit5 in a random order",
    "mean_rank": "mean rank of the clip that was shown; 1 is best",
    "chance_rank": "mean rank in a random order",
    "precision5": "share of the first 5 that has the keyword",
    "precision10": "share of the first 10 that has the keyword",
    "mean_average_precision": "precision at the rank of each segment that has the keyword, averaged",
    "chance_precision": "share of all segments that has the keyword",
    "mean_first": "mean rank of the first clip that has the keyword",
    "chance_first": "mean first in a random order",
    "seconds": "median seconds per query",
    "segments": "segments that are ranked",
    "queries": "who played the queries",
    "ranks": "the file of rankings that the row was computed from",
    "note": "why a row is empty",
}

SUFFIXES = {
    "_low": "lower end of the 95 % interval",
    "_high": "upper end of the 95 % interval",
    "_paper": "as the paper prints it",
    "_mean_pose": "the same for the mean pose",
}


def columns(names: Sequence[str]) -> list[tuple[str, str]]:
    """What the columns of a table of rankings hold, by the names that the page shows."""
    found = [(name, COLUMNS[name]) for name in names if name in COLUMNS]
    found += [(f"… {end}", words) for end, words in SUFFIXES.items() if any(n.endswith(end) for n in names)]
    return [(name.replace("_", " ").replace("  ", " "), words) for name, words in found]
