# The 42 values of each frame; yaw is counted anew in each segment.


rule features:
    input:
        motion="results/{corpus}/motion/{shard}.h5",
        segments="results/{corpus}/segments/{shard}.h5",
    output:
        "results/{corpus}/features/{shard}.h5",
    log:
        "results/logs/features/{corpus}/{shard}.log",
    benchmark:
        "results/benchmarks/features/{corpus}/{shard}.tsv"
    priority: SEARCHED
    resources:
        mem_mb=megabytes(600, 40),
        runtime=minutes(5, 0.1),
    params:
        joints=lambda wildcards: FLOW.per_take(
            wildcards.corpus, wildcards.shard, "joints"
        ),
        settings=CONFIG.features.model_dump(),
        code=code("features.py"),
    script:
        "../scripts/features.py"
