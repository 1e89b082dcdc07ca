# The figures of [H] for any string, joint and axis, and how models do on intervals that they have not seen.


rule curves_of:
    input:
        synthesis="results/{corpus}/synthesis/{string}.h5",
        motion=lambda wildcards: FLOW.of_shards(wildcards.corpus, "motion"),
        annotations="results/{corpus}/annotations.tsv",
    output:
        fig4="results/{corpus}/figures/{string}/{angle}/fig4.{kind}",
        fig5="results/{corpus}/figures/{string}/{angle}/fig5.{kind}",
        staircase="results/{corpus}/figures/{string}/{angle}/staircase.{kind}",
    log:
        "results/logs/figures/{corpus}/{string}_{angle}_{kind}.log",
    benchmark:
        "results/benchmarks/figures/{corpus}/{string}_{angle}_{kind}.tsv"
    wildcard_constraints:
        kind="png|svg|pdf",
    resources:
        mem_mb=megabytes(800, 30),
        runtime=minutes(5),
    params:
        angle="{angle}",
        simulated=lambda wildcards: FLOW.simulated(wildcards.corpus),
        code=code("curves.py"),
    script:
        "../scripts/curves.py"


rule strips_of:
    input:
        "results/{corpus}/synthesis/{string}.h5",
    output:
        "results/{corpus}/figures/{string}/fig6.png",
    log:
        "results/logs/figures/{corpus}/{string}_strips.log",
    benchmark:
        "results/benchmarks/figures/{corpus}/{string}_strips.tsv"
    resources:
        mem_mb=megabytes(1500),
        runtime=minutes(10),
    params:
        changes=lambda wildcards: FLOW.changes(wildcards.string),
        simulated=lambda wildcards: FLOW.simulated(wildcards.corpus),
        code=code("strips.py"),
    script:
        "../scripts/strips.py"


rule left_out:
    input:
        motion=lambda wildcards: FLOW.of_shards(wildcards.corpus, "motion"),
        annotations="results/{corpus}/annotations.tsv",
    output:
        table="results/{corpus}/left_out.csv",
        plot="results/{corpus}/left_out.png",
    log:
        "results/logs/left_out/{corpus}.log",
    benchmark:
        "results/benchmarks/left_out/{corpus}.tsv"
    resources:
        mem_mb=megabytes(800, 60),
        runtime=minutes(60, 10),
    params:
        settings=CONFIG.train.model_dump(exclude={"states", "covariance"}),
        simulated=lambda wildcards: FLOW.simulated(wildcards.corpus),
        code=code("left_out.py"),
    script:
        "../scripts/left_out.py"
