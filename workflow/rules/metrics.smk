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
    output:
        "results/metrics.json",
    log:
        "results/logs/metrics/metrics.log",
    benchmark:
        "results/benchmarks/metrics/metrics.tsv"
    params:
        code=code("metrics.py"),
    resources:
        mem_mb=megabytes(600),
        runtime=minutes(5),
    script:
        "../scripts/metrics.py"


rule check:
    input:
        "results/metrics.json",
    log:
        "results/logs/metrics/check.log",
    params:
        baseline=CONFIG.baseline,
    resources:
        mem_mb=megabytes(300),
        runtime=minutes(5),
    script:
        "../scripts/check.py"


rule accept:
    input:
        "results/metrics.json",
    log:
        "results/logs/metrics/accept.log",
    params:
        baseline=CONFIG.baseline,
    resources:
        mem_mb=megabytes(300),
        runtime=minutes(5),
    script:
        "../scripts/accept.py"
