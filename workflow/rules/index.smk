# One index of all segments of a corpus.


rule index:
    input:
        lambda wildcards: FLOW.of_shards(wildcards.corpus, "features"),
    output:
        "results/{corpus}/index.h5",
    log:
        "results/logs/index/{corpus}.log",
    benchmark:
        "results/benchmarks/index/{corpus}.tsv"
    resources:
        mem_mb=megabytes(600, 10),
        runtime=minutes(5, 0.1),
    params:
        dims=CONFIG.index.dims,
        samples=CONFIG.index.samples,
        seed=CONFIG.seed,
        code=code("index.py"),
    script:
        "../scripts/index.py"
