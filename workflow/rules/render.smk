# Films and contact sheets: of synthesised strings, of the config's films, of any take by its name.


rule film_string:
    input:
        "results/{corpus}/synthesis/{string}.h5",
    output:
        film=report(
            "results/{corpus}/film/{string}.mp4",
            caption="../report/film.rst",
            category="Films",
            labels={"corpus": "{corpus}", "what": "{string}"},
        ),
        sheet=report(
            "results/{corpus}/film/{string}_sheet.png",
            caption="../report/film.rst",
            category="Films",
            labels={"corpus": "{corpus}", "what": "{string}, pictures"},
        ),
    log:
        "results/logs/render/{corpus}/{string}.log",
    benchmark:
        "results/benchmarks/render/{corpus}/{string}.tsv"
    resources:
        mem_mb=megabytes(1500),
        runtime=minutes(15),
    params:
        simulated=lambda wildcards: FLOW.simulated(wildcards.corpus),
        settings=CONFIG.render.model_dump(),
        code=code("film_string.py"),
    script:
        "../scripts/film_string.py"


rule film_take:
    input:
        lambda wildcards: FLOW.motion_of(wildcards.corpus, wildcards.name),
    output:
        film=report(
            "results/{corpus}/film/{name}.mp4",
            caption="../report/film.rst",
            category="Films",
            labels={"corpus": "{corpus}", "what": "{name}"},
        ),
        sheet=report(
            "results/{corpus}/film/{name}_sheet.png",
            caption="../report/film.rst",
            category="Films",
            labels={"corpus": "{corpus}", "what": "{name}, pictures"},
        ),
    log:
        "results/logs/render/{corpus}/{name}.log",
    benchmark:
        "results/benchmarks/render/{corpus}/{name}.tsv"
    resources:
        mem_mb=megabytes(1500, 30),
        runtime=minutes(30),
    params:
        stretch=lambda wildcards: FLOW.stretch(wildcards.corpus, wildcards.name),
        simulated=lambda wildcards: FLOW.simulated(wildcards.corpus),
        settings=CONFIG.render.model_dump(),
        code=code("film_take.py"),
    script:
        "../scripts/film_take.py"


rule film_compared:
    input:
        synthesis="results/{corpus}/synthesis/{string}.h5",
        motion=lambda wildcards: FLOW.of_shards(wildcards.corpus, "motion"),
        annotations="results/{corpus}/annotations.tsv",
    output:
        report(
            "results/{corpus}/compared/{string}.mp4",
            caption="../report/compared.rst",
            category="Films",
            labels={"corpus": "{corpus}", "what": "{string}, three ways"},
        ),
    log:
        "results/logs/render/{corpus}/{string}_compared.log",
    benchmark:
        "results/benchmarks/render/{corpus}/{string}_compared.tsv"
    resources:
        mem_mb=megabytes(1500, 10),
        runtime=minutes(15),
    params:
        simulated=lambda wildcards: FLOW.simulated(wildcards.corpus),
        settings=CONFIG.render.model_dump(),
        code=code("film_compared.py"),
    script:
        "../scripts/film_compared.py"


rule animation:
    input:
        "results/{corpus}/synthesis/{string}.h5",
    output:
        "results/{corpus}/animation/{string}.webp",
    log:
        "results/logs/render/{corpus}/{string}_animation.log",
    benchmark:
        "results/benchmarks/render/{corpus}/{string}_animation.tsv"
    resources:
        mem_mb=megabytes(1500),
        runtime=minutes(15),
    params:
        simulated=lambda wildcards: FLOW.simulated(wildcards.corpus),
        settings=dict(fps=15.0, width=320, height=320),
        code=code("film_string.py"),
    script:
        "../scripts/film_string.py"
