# One page that shows the run.


rule page:
    input:
        **FLOW.shown(),
        tables=FLOW.tables(),
        figures=FLOW.figures(),
        films=FLOW.films(),
        searches=FLOW.searches(),
        lengths=FLOW.lengths(),
        indices=FLOW.indices(),
        metrics="results/metrics.json",
        skipped=FLOW.of_corpora("skipped.csv"),
        takes=FLOW.of_corpora("takes.csv"),
        annotations=FLOW.of_corpora("annotations.tsv"),
    output:
        report(
            "results/report.html",
            caption="../report/page.rst",
            category="Report",
            labels={"what": "the whole run on one page"},
        ),
    log:
        "results/logs/report/page.log",
    benchmark:
        "results/benchmarks/report/page.tsv"
    resources:
        mem_mb=megabytes(1000, 10),
        runtime=minutes(15, 0.1),
    params:
        corpora=FLOW.described(),
        config=CONFIG.model_dump(mode="json"),
        joints=FLOW.named_joints(),
        code=code("page.py"),
    script:
        "../scripts/page.py"
