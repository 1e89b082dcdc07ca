# One index of all segments of a corpus; the GP-LVMs of its segments only where a measure asks for them.


rule index:
    input:
        lambda wildcards: FLOW.of_shards(wildcards.corpus, "features"),
    output:
        "results/{corpus}/index.h5",
    log:
        "results/logs/index/{corpus}.log",
    benchmark:
        "results/benchmarks/index/{corpus}.tsv"
    priority: SEARCHED
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


rule gplvm:
    input:
        "results/{corpus}/index.h5",
    output:
        "results/{corpus}/gplvm.h5",
    log:
        "results/logs/gplvm/{corpus}.log",
    benchmark:
        "results/benchmarks/gplvm/{corpus}.tsv"
    priority: SEARCHED
    resources:
        mem_mb=megabytes(800, 20),
        runtime=minutes(5, 1),
    params:
        settings=CONFIG.gplvm.model_dump(),
        code=code("gplvm.py"),
    script:
        "../scripts/gplvm.py"
