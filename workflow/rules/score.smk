# Ranks against what was meant: the two protocols of [P], and ranking across subjects.


rule score:
    input:
        ranks=lambda wildcards: FLOW.ranks(wildcards.experiment),
        table="data/raw/{corpus}/queries/{experiment}/queries.tsv",
        index="results/{corpus}/index.h5",
        takes="results/{corpus}/takes.csv",
        annotations="results/{corpus}/annotations.tsv",
    output:
        report(
            "results/{corpus}/scores/{experiment}.csv",
            caption="../report/scores.rst",
            category="Scores",
            labels={"corpus": "{corpus}", "experiment": "{experiment}"},
        ),
    log:
        "results/logs/score/{corpus}/{experiment}.log",
    benchmark:
        "results/benchmarks/score/{corpus}/{experiment}.tsv"
    resources:
        mem_mb=megabytes(800, 5),
        runtime=minutes(10),
    params:
        code=code("score.py"),
    script:
        "../scripts/score.py"
