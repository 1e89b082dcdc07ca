# Every number worth watching in one file, and the comparison with the committed baseline.


localrules:
    check,
    accept,


rule metrics:
    input:
        scores=FLOW.scores(),
        lengths=FLOW.lengths(),
        annotations=FLOW.of_corpora("annotations.tsv"),
        takes=FLOW.of_corpora("takes.csv"),
        indices=FLOW.indices(),
        agreements=FLOW.agreements(),
    output:
        report(
            "results/metrics.json",
            caption="../report/metrics.rst",
            category="Metrics",
            labels={"what": "all metrics of the run"},
        ),
    log:
        "results/logs/metrics/metrics.log",
    benchmark:
        "results/benchmarks/metrics/metrics.tsv"
    resources:
        mem_mb=megabytes(600),
        runtime=minutes(5),
    params:
        code=code("metrics.py"),
    script:
        "../scripts/metrics.py"


rule check:
    input:
        "results/metrics.json",
    log:
        "results/logs/metrics/check.log",
    resources:
        mem_mb=megabytes(300),
        runtime=minutes(5),
    params:
        baseline=CONFIG.baseline,
    script:
        "../scripts/check.py"


rule accept:
    input:
        "results/metrics.json",
    log:
        "results/logs/metrics/accept.log",
    resources:
        mem_mb=megabytes(300),
        runtime=minutes(5),
    params:
        baseline=CONFIG.baseline,
    script:
        "../scripts/accept.py"
