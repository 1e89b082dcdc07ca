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
    priority: SEARCHED
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


rule segment_lengths:
    input:
        segments=lambda wildcards: FLOW.of_shards(wildcards.corpus, "segments"),
        takes="results/{corpus}/takes.csv",
    output:
        report(
            "results/{corpus}/segment_lengths.csv",
            caption="../report/segment_lengths.rst",
            category="Segmentation",
            labels={"corpus": "{corpus}", "what": "lengths of segments"},
        ),
    log:
        "results/logs/segment_lengths/{corpus}.log",
    benchmark:
        "results/benchmarks/segment_lengths/{corpus}.tsv"
    resources:
        mem_mb=megabytes(600),
        runtime=minutes(5),
    params:
        code=code("segment_lengths.py"),
    script:
        "../scripts/segment_lengths.py"


rule segmentation:
    input:
        segments=lambda wildcards: FLOW.of_shards(wildcards.corpus, "segments"),
        takes="results/{corpus}/takes.csv",
        annotations="results/{corpus}/annotations.tsv",
        points=lambda wildcards: FLOW.cut_points(wildcards.corpus),
    output:
        report(
            "results/{corpus}/segmentation.csv",
            caption="../report/segmentation.rst",
            category="Segmentation",
            labels={"corpus": "{corpus}", "what": "cuts against annotations"},
        ),
    log:
        "results/logs/segmentation/{corpus}.log",
    benchmark:
        "results/benchmarks/segmentation/{corpus}.tsv"
    resources:
        mem_mb=megabytes(600),
        runtime=minutes(5),
    params:
        bounded=lambda wildcards: FLOW.bounded(wildcards.corpus),
        people=lambda wildcards: (
            "simulated" if FLOW.simulated(wildcards.corpus) else "recorded"
        ),
        seed=CONFIG.seed,
        code=code("segmentation.py"),
    script:
        "../scripts/segmentation.py"
