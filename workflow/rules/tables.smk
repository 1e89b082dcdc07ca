# Scores → the tables of the papers with ours beside theirs; synthesised motion → the figures of [H].

# what Snakemake's report calls the tables
_NAMES = {
    "table1": ("[P]", "table 1: hits"),
    "table2": ("[P]", "table 2: ranks"),
    "table3": ("[P]", "table 3: hits, larger database"),
    "table4": ("[P]", "table 4: seconds"),
    "table5": ("[P]", "table 5: seconds, larger database"),
    "differences1": ("ours", "measures in pairs, experiment 1"),
    "differences2": ("ours", "measures in pairs, experiment 2"),
    "other_people": ("ours", "only other people's clips"),
}

for _table, _experiment in FLOW.filled_tables().items():

    rule:
        name:
            _table
        input:
            scores=FLOW.scores_of(_experiment),
        output:
            report(
                f"results/{_table}.csv",
                caption=f"../report/{_table}.rst",
                category="Tables",
                labels=dict(zip(("paper", "what"), _NAMES[_table])),
            ),
        log:
            f"results/logs/tables/{_table}.log",
        benchmark:
            f"results/benchmarks/tables/{_table}.tsv"
        resources:
            mem_mb=megabytes(600),
            runtime=minutes(5),
        params:
            table=_table,
            seed=CONFIG.seed,
            code=code("tables.py"),
        script:
            "../scripts/tables.py"


if CONFIG.tables.string:

    rule label_counts:
        input:
            annotations=FLOW.of_string("annotations.tsv"),
            lengths=FLOW.of_string("synthesis/{string}.csv"),
        output:
            report(
                "results/label_counts.csv",
                caption="../report/label_counts.rst",
                category="Tables",
                labels={"paper": "[H]", "what": "table 2, and lengths of the string"},
            ),
        log:
            "results/logs/tables/label_counts.log",
        benchmark:
            "results/benchmarks/tables/label_counts.tsv"
        resources:
            mem_mb=megabytes(500),
            runtime=minutes(5),
        params:
            string=CONFIG.strings[CONFIG.tables.string].labels,
            simulated=FLOW.simulated(FLOW.shown_corpus()),
            code=code("label_counts.py"),
        script:
            "../scripts/label_counts.py"

    rule curves:
        input:
            synthesis=FLOW.of_string("synthesis/{string}.h5"),
            motion=FLOW.of_shards(FLOW.shown_corpus(), "motion"),
            annotations=FLOW.of_string("annotations.tsv"),
        output:
            fig4=report(
                "results/fig4.png",
                caption="../report/fig4.rst",
                category="Figures",
                labels={"paper": "[H]", "what": "figure 4: generated"},
            ),
            fig5=report(
                "results/fig5.png",
                caption="../report/fig5.rst",
                category="Figures",
                labels={"paper": "[H]", "what": "figure 5: put end to end"},
            ),
            staircase=report(
                "results/staircase.png",
                caption="../report/staircase.rst",
                category="Figures",
                labels={"paper": "[H]", "what": "states and trajectory"},
            ),
        log:
            "results/logs/figures/curves.log",
        benchmark:
            "results/benchmarks/figures/curves.tsv"
        resources:
            mem_mb=megabytes(800, 30),
            runtime=minutes(5),
        params:
            angle=CONFIG.tables.angle,
            simulated=FLOW.simulated(FLOW.shown_corpus()),
            code=code("curves.py"),
        script:
            "../scripts/curves.py"

    rule strips:
        input:
            FLOW.of_string("synthesis/{string}.h5"),
        output:
            report(
                "results/fig6.png",
                caption="../report/fig6.rst",
                category="Figures",
                labels={"paper": "[H]", "what": "figure 6: changes"},
            ),
        log:
            "results/logs/figures/strips.log",
        benchmark:
            "results/benchmarks/figures/strips.tsv"
        resources:
            mem_mb=megabytes(1500),
            runtime=minutes(10),
        params:
            changes=FLOW.changes(CONFIG.tables.string),
            simulated=FLOW.simulated(FLOW.shown_corpus()),
            code=code("strips.py"),
        script:
            "../scripts/strips.py"
