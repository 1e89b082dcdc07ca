# Labelled intervals → an HMM with state durations for each label.


rule train:
    input:
        motion=lambda wildcards: FLOW.of_shards(wildcards.corpus, "motion"),
        annotations="results/{corpus}/annotations.tsv",
    output:
        "results/{corpus}/models/{label}.h5",
    log:
        "results/logs/train/{corpus}/{label}.log",
    benchmark:
        "results/benchmarks/train/{corpus}/{label}.tsv"
    resources:
        mem_mb=megabytes(600, 60),
        runtime=minutes(10, 1),
    params:
        settings=CONFIG.train.model_dump(),
        code=code("train.py"),
    script:
        "../scripts/train.py"
