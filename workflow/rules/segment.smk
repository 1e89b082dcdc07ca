# Takes are cut where one motion ends and the next begins.


rule segment:
    input:
        "results/{corpus}/motion/{shard}.h5",
    output:
        "results/{corpus}/segments/{shard}.h5",
    log:
        "results/logs/segment/{corpus}/{shard}.log",
    benchmark:
        "results/benchmarks/segment/{corpus}/{shard}.tsv"
    resources:
        mem_mb=megabytes(600, 30),
        runtime=minutes(10, 1),
    params:
        cut=lambda wildcards: FLOW.per_take(wildcards.corpus, wildcards.shard, "cut"),
        joints=lambda wildcards: FLOW.per_take(
            wildcards.corpus, wildcards.shard, "joints"
        ),
        settings=CONFIG.segment.model_dump(),
        code=code("segment.py"),
    script:
        "../scripts/segment.py"
