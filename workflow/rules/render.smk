# Films and contact sheets: of synthesised strings, of the config's films, of any take by its name.


rule film_string:
    input:
        "results/{corpus}/synthesis/{string}.h5",
    output:
        film="results/{corpus}/film/{string}.mp4",
        sheet="results/{corpus}/film/{string}_sheet.png",
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
        film="results/{corpus}/film/{name}.mp4",
        sheet="results/{corpus}/film/{name}_sheet.png",
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
