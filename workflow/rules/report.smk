# One page that shows the run.


rule page:
    input:
        **FLOW.shown(),
        tables=FLOW.tables() + FLOW.comparisons(),
        figures=FLOW.figures(),
        films=FLOW.films(),
        searches=FLOW.searches(),
        segmentation=FLOW.segmentations(),
        lengths=FLOW.lengths(),
        indices=FLOW.indices(),
        metrics="results/metrics.json",
        skipped=FLOW.of_corpora("skipped.csv"),
        takes=FLOW.of_corpora("takes.csv"),
        annotations=FLOW.of_corpora("annotations.tsv"),
    output:
        report(
            "results/report.html",
            caption="../report/page.rst",
            category="Report",
            labels={"what": "the whole run on one page"},
        ),
    log:
        "results/logs/report/page.log",
    benchmark:
        "results/benchmarks/report/page.tsv"
    resources:
        mem_mb=megabytes(1000, 10),
        runtime=minutes(15, 0.1),
    params:
        corpora=FLOW.described(),
        config=CONFIG.model_dump(mode="json"),
        joints=FLOW.named_joints(),
        code=code("page.py"),
    script:
        "../scripts/page.py"


rule search_page:
    input:
        table="results/{corpus}/search/{query}.csv",
        index="results/{corpus}/index.h5",
        motion=lambda wildcards: FLOW.of_shards(wildcards.corpus, "motion"),
        log=lambda wildcards: FLOW.log_of(wildcards.corpus, wildcards.query),
    output:
        report(
            "results/{corpus}/search/{query}.html",
            caption="../report/search.rst",
            category="Searches",
            labels={"corpus": "{corpus}", "query": "{query}", "what": "page"},
        ),
    log:
        "results/logs/search_page/{corpus}/{query}.log",
    benchmark:
        "results/benchmarks/search_page/{corpus}/{query}.tsv"
    resources:
        mem_mb=megabytes(800, 10),
        runtime=minutes(10, 0.1),
    params:
        simulated=lambda wildcards: FLOW.simulated(wildcards.corpus),
        settings=CONFIG.features.model_dump(),
        code=code("search_page.py"),
    script:
        "../scripts/search_page.py"
