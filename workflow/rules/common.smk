# What all rules share: the checked config, takes and shards, digests of code, sizes of jobs. No rules.

import os
import time
from pathlib import Path

from miburi import corpora, flow
from miburi.code import code_digest

# one thread in each sum, so that the same inputs give the same bytes; jobs are what runs side by side
os.environ.update(
    dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
)

SCRIPTS = Path(workflow.basedir) / "workflow" / "scripts"
STARTED = time.time()
FLOW = flow.plan(config)
CONFIG = FLOW.config


# the way from bodies to ranks is the longest: its jobs go first, so that no core is idle at the end
SEARCHED = 5


wildcard_constraints:
    corpus=flow.one_of(CONFIG.corpora),
    shard="[01]*-?[01]+|all",
    experiment=flow.one_of(CONFIG.experiments),
    string=flow.one_of(CONFIG.strings),
    measure="[^/]+",
    label="[^/]+",
    name=flow.none_of(CONFIG.strings),
    query="[^/]+",


def code(script):
    """Digest of a script and all library modules that it needs."""
    return code_digest(str(SCRIPTS / script))


def trained_or_recorded(wildcards):
    """Models of a string's labels, or for one that is drawn at random what all models are trained on."""
    if FLOW.is_random(wildcards.string):
        return {
            "motion": FLOW.of_shards(wildcards.corpus, "motion"),
            "annotations": f"results/{wildcards.corpus}/annotations.tsv",
        }
    return {"models": FLOW.models(wildcards.corpus, wildcards.string)}


def size(paths):
    """Megabytes of files. Snakemake's own `size_mb` cannot be asked while a report is made, and warns."""
    return sum(os.path.getsize(path) for path in paths) / 2**20


def megabytes(base, factor=0):
    """Memory of a job: a base and a multiple of its input's size."""
    return lambda wildcards, input: int(base + factor * size(input))


def minutes(base, per_mb=0.0):
    """Run time of a job: a base and so much for each megabyte of its input."""
    return lambda wildcards, input: int(base + per_mb * size(input))


onerror:
    flow.say_last(STARTED)
