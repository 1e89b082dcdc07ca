# A string of labels → the most likely motion; its length by all four ways of counting; its largest jump.


rule synthesize:
    input:
        lambda wildcards: [
            f"results/{wildcards.corpus}/models/{label}.h5"
            for label in FLOW.labels(wildcards.string)
        ],
    output:
        "results/{corpus}/synthesis/{string}.h5",
    log:
        "results/logs/synthesize/{corpus}/{string}.log",
    benchmark:
        "results/benchmarks/synthesize/{corpus}/{string}.tsv"
    resources:
        mem_mb=megabytes(600),
        runtime=minutes(5),
    params:
        string=lambda wildcards: FLOW.string(wildcards.string),
        code=code("synthesize.py"),
    script:
        "../scripts/synthesize.py"


rule lengths:
    input:
        synthesis="results/{corpus}/synthesis/{string}.h5",
        motion=lambda wildcards: FLOW.of_shards(wildcards.corpus, "motion"),
        annotations="results/{corpus}/annotations.tsv",
    output:
        "results/{corpus}/synthesis/{string}.csv",
    log:
        "results/logs/lengths/{corpus}/{string}.log",
    benchmark:
        "results/benchmarks/lengths/{corpus}/{string}.tsv"
    resources:
        mem_mb=megabytes(800, 60),
        runtime=minutes(10, 1),
    params:
        string=lambda wildcards: FLOW.string(wildcards.string),
        settings=CONFIG.train.model_dump(),
        code=code("lengths.py"),
    script:
        "../scripts/lengths.py"
