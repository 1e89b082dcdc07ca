# What stands in for people: simulated recordings in the devices' own formats, and the download of real ones.

for _name in FLOW.performed("janken"):

    rule:
        name:
            f"perform_{_name}"
        output:
            FLOW.performance(_name),
        log:
            f"results/logs/perform/{_name}.log",
        benchmark:
            f"results/benchmarks/perform/{_name}.tsv"
        resources:
            mem_mb=megabytes(800),
            runtime=minutes(5),
        params:
            small=FLOW.corpus(_name).small,
            seed=CONFIG.seed,
            code=code("perform_janken.py"),
        script:
            "../scripts/perform_janken.py"


for _name in FLOW.performed("everyday"):

    rule:
        name:
            f"perform_{_name}"
        output:
            f"data/raw/{_name}/annotations.tsv",
        log:
            f"results/logs/perform/{_name}.log",
        benchmark:
            f"results/benchmarks/perform/{_name}.tsv"
        resources:
            mem_mb=megabytes(500),
            runtime=minutes(5),
        params:
            takes=[],
            small=FLOW.corpus(_name).small,
            seed=CONFIG.seed,
            code=code("perform_everyday.py"),
        script:
            "../scripts/perform_everyday.py"

    for _performer in FLOW.performers(_name):

        rule:
            name:
                f"perform_{_name}_{_performer}"
            output:
                list(FLOW.performed_by(_name, _performer).values()),
            log:
                f"results/logs/perform/{_name}/{_performer}.log",
            benchmark:
                f"results/benchmarks/perform/{_name}/{_performer}.tsv"
            priority: SEARCHED
            resources:
                mem_mb=megabytes(1000),
                runtime=minutes(10),
            params:
                takes=list(FLOW.performed_by(_name, _performer)),
                small=FLOW.corpus(_name).small,
                seed=CONFIG.seed,
                code=code("perform_everyday.py"),
            script:
                "../scripts/perform_everyday.py"


for _name, _subject in FLOW.fetched():

    rule:
        name:
            f"fetch_{_name}_{_subject}"
        output:
            FLOW.downloads(_name, _subject),
        log:
            f"results/logs/fetch/{_name}/{_subject}.log",
        benchmark:
            f"results/benchmarks/fetch/{_name}/{_subject}.tsv"
        resources:
            mem_mb=megabytes(500),
            runtime=minutes(120),
        params:
            site=FLOW.corpus(_name).site,
            subject=_subject,
            code=code("fetch.py"),
        script:
            "../scripts/fetch.py"


rule queries:
    input:
        motion=lambda wildcards: FLOW.of_shards(wildcards.corpus, "motion"),
        segments=lambda wildcards: FLOW.of_shards(wildcards.corpus, "segments"),
        takes="results/{corpus}/takes.csv",
        annotations="results/{corpus}/annotations.tsv",
    output:
        table="data/raw/{corpus}/queries/{experiment}/queries.tsv",
        logs=directory("data/raw/{corpus}/queries/{experiment}/logs"),
    log:
        "results/logs/queries/{corpus}/{experiment}.log",
    benchmark:
        "results/benchmarks/queries/{corpus}/{experiment}.tsv"
    priority: SEARCHED
    resources:
        mem_mb=megabytes(1000, 10),
        runtime=minutes(20, 0.1),
    params:
        experiment=lambda wildcards: FLOW.to_play(wildcards.experiment),
        seed=CONFIG.seed,
        code=code("queries.py"),
    script:
        "../scripts/queries.py"
