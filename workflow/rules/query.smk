# Queries are played, read like any log, and every measure ranks the segments for them.


rule query_features:
    input:
        table="data/raw/{corpus}/queries/{experiment}/queries.tsv",
        logs="data/raw/{corpus}/queries/{experiment}/logs",
    output:
        "results/{corpus}/queries/{experiment}.h5",
    log:
        "results/logs/query_features/{corpus}/{experiment}.log",
    benchmark:
        "results/benchmarks/query_features/{corpus}/{experiment}.tsv"
    priority: SEARCHED
    resources:
        mem_mb=megabytes(800, 20),
        runtime=minutes(10, 0.1),
    params:
        settings=CONFIG.features.model_dump(),
        code=code("query_features.py"),
    script:
        "../scripts/query_features.py"


rule rank:
    input:
        index="results/{corpus}/index.h5",
        models=lambda wildcards: FLOW.gplvm(wildcards.corpus, wildcards.measure),
        table="data/raw/{corpus}/queries/{experiment}/queries.tsv",
        queries="results/{corpus}/queries/{experiment}.h5",
        takes="results/{corpus}/takes.csv",
    output:
        "results/{corpus}/ranks/{experiment}/{measure}.h5",
    log:
        "results/logs/rank/{corpus}/{experiment}/{measure}.log",
    benchmark:
        "results/benchmarks/rank/{corpus}/{experiment}/{measure}.tsv"
    priority: SEARCHED
    resources:
        mem_mb=megabytes(1000, 10),
        runtime=minutes(10, 1),
    params:
        reduction=CONFIG.index.reduction,
        code=code("rank.py"),
    script:
        "../scripts/rank.py"


rule search:
    input:
        index="results/{corpus}/index.h5",
        models=lambda wildcards: FLOW.gplvm(wildcards.corpus, CONFIG.search_measure),
        takes="results/{corpus}/takes.csv",
        log=lambda wildcards: FLOW.log_of(wildcards.corpus, wildcards.query),
    output:
        report(
            "results/{corpus}/search/{query}.csv",
            caption="../report/search.rst",
            category="Searches",
            labels={"corpus": "{corpus}", "query": "{query}", "what": "table"},
        ),
    log:
        "results/logs/search/{corpus}/{query}.log",
    benchmark:
        "results/benchmarks/search/{corpus}/{query}.tsv"
    resources:
        mem_mb=megabytes(1000, 10),
        runtime=minutes(10, 0.1),
    params:
        measure=CONFIG.search_measure,
        simulated=lambda wildcards: FLOW.simulated_log(
            wildcards.corpus, wildcards.query
        ),
        reduction=CONFIG.index.reduction,
        settings=CONFIG.features.model_dump(),
        code=code("search.py"),
    script:
        "../scripts/search.py"


rule puppeteers:
    input:
        index="results/{corpus}/index.h5",
        motion=lambda wildcards: FLOW.of_shards(wildcards.corpus, "motion"),
        targets=lambda wildcards: FLOW.targets(wildcards.corpus),
        logs=lambda wildcards: list(FLOW.own_logs(wildcards.corpus).values()),
    output:
        report(
            "results/{corpus}/puppeteers.csv",
            caption="../report/puppeteers.rst",
            category="Tables",
            labels={"paper": "ours", "what": "two puppeteers, {corpus}"},
        ),
    log:
        "results/logs/puppeteers/{corpus}.log",
    benchmark:
        "results/benchmarks/puppeteers/{corpus}.tsv"
    resources:
        mem_mb=megabytes(1000, 10),
        runtime=minutes(20, 0.1),
    params:
        compared=lambda wildcards: FLOW.to_compare(wildcards.corpus),
        reduction=CONFIG.index.reduction,
        settings=CONFIG.features.model_dump(),
        seed=CONFIG.seed,
        code=code("puppeteers.py"),
    script:
        "../scripts/puppeteers.py"
