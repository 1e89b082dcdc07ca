# One page that shows the run.


rule page:
    input:
        tables=FLOW.tables() + FLOW.comparisons(),
        figures=FLOW.figures(),
        films=FLOW.films(),
        searches=FLOW.searches(),
        metrics="results/metrics.json",
        skipped=FLOW.of_corpora("skipped.csv"),
        takes=FLOW.of_corpora("takes.csv"),
    output:
        "results/report.html",
    log:
        "results/logs/report/page.log",
    benchmark:
        "results/benchmarks/report/page.tsv"
    resources:
        mem_mb=megabytes(600, 5),
        runtime=minutes(5),
    params:
        corpora=FLOW.described(),
        code=code("page.py"),
    script:
        "../scripts/page.py"
