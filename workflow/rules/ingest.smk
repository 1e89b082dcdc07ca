# Recordings → motion, a shard at a time; what happens in them → annotations.


rule ingest:
    input:
        lambda wildcards: FLOW.files(wildcards.corpus, wildcards.shard),
    output:
        motion="results/{corpus}/motion/{shard}.h5",
        skipped="results/{corpus}/motion/{shard}_skipped.csv",
    log:
        "results/logs/ingest/{corpus}/{shard}.log",
    benchmark:
        "results/benchmarks/ingest/{corpus}/{shard}.tsv"
    priority: SEARCHED
    resources:
        mem_mb=megabytes(500, 30),
        runtime=minutes(5, 0.1),
    params:
        reading=lambda wildcards: FLOW.to_read(wildcards.corpus, wildcards.shard),
        on_error=CONFIG.on_error,
        code=code("ingest.py"),
    script:
        "../scripts/ingest.py"


rule annotations:
    input:
        motion=lambda wildcards: FLOW.of_shards(wildcards.corpus, "motion"),
        files=lambda wildcards: FLOW.annotation_files(wildcards.corpus),
    output:
        takes="results/{corpus}/takes.csv",
        annotations="results/{corpus}/annotations.tsv",
        skipped="results/{corpus}/skipped.csv",
    log:
        "results/logs/annotations/{corpus}.log",
    benchmark:
        "results/benchmarks/annotations/{corpus}.tsv"
    priority: SEARCHED
    resources:
        mem_mb=megabytes(600, 30),
        runtime=minutes(5, 0.1),
    params:
        reading=lambda wildcards: FLOW.to_annotate(wildcards.corpus),
        code=code("annotations.py"),
    script:
        "../scripts/annotations.py"
