# Successions of labels → the words of a string → the most likely motion; its length by all four ways of counting.


rule successions:
    input:
        "results/{corpus}/annotations.tsv",
    output:
        "results/{corpus}/successions.csv",
    log:
        "results/logs/successions/{corpus}.log",
    benchmark:
        "results/benchmarks/successions/{corpus}.tsv"
    resources:
        mem_mb=megabytes(300),
        runtime=minutes(5),
    params:
        code=code("successions.py"),
    script:
        "../scripts/successions.py"


rule words:
    input:
        annotations="results/{corpus}/annotations.tsv",
        successions="results/{corpus}/successions.csv",
    output:
        "results/{corpus}/synthesis/{string}.txt",
    log:
        "results/logs/words/{corpus}/{string}.log",
    benchmark:
        "results/benchmarks/words/{corpus}/{string}.tsv"
    priority: 10  # what is wrong with a string is said before anything is trained
    resources:
        mem_mb=megabytes(300),
        runtime=minutes(5),
    params:
        string=lambda wildcards: FLOW.words(wildcards.string),
        code=code("words.py"),
    script:
        "../scripts/words.py"


rule synthesize:
    input:
        # which models a string needs that is drawn at random is known only then: it trains them itself
        unpack(trained_or_recorded),
        words="results/{corpus}/synthesis/{string}.txt",
    output:
        "results/{corpus}/synthesis/{string}.h5",
    log:
        "results/logs/synthesize/{corpus}/{string}.log",
    benchmark:
        "results/benchmarks/synthesize/{corpus}/{string}.tsv"
    resources:
        mem_mb=megabytes(600, 60),
        runtime=minutes(10, 5),
    params:
        string=lambda wildcards: FLOW.string(wildcards.string),
        seed=CONFIG.seed,
        training=lambda wildcards: FLOW.training(wildcards.string),
        code=code("synthesize.py"),
    script:
        "../scripts/synthesize.py"


rule lengths:
    input:
        synthesis="results/{corpus}/synthesis/{string}.h5",
        motion=lambda wildcards: FLOW.of_shards(wildcards.corpus, "motion"),
        annotations="results/{corpus}/annotations.tsv",
    output:
        lengths="results/{corpus}/synthesis/{string}.csv",
        delays="results/{corpus}/synthesis/{string}_delays.csv",
    log:
        "results/logs/lengths/{corpus}/{string}.log",
    benchmark:
        "results/benchmarks/lengths/{corpus}/{string}.tsv"
    resources:
        mem_mb=megabytes(800, 60),
        runtime=minutes(10, 1),
    params:
        settings=CONFIG.train.model_dump(),
        code=code("lengths.py"),
    script:
        "../scripts/lengths.py"
