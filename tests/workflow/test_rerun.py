"""A change re-runs what depends on it and nothing else, seen by `snakemake -n`."""

from __future__ import annotations

import re

import yaml
from tests.workflow.conftest import Project

TABLES = {"table1", "table2", "table3", "table4", "table5", "differences1", "differences2"}
AFTER_RANK = {"rank", "score", *TABLES, "metrics", "page", "all"}
BODY_CHAIN = {"ingest", "segment", "features", "annotations", "index", "queries", "query_features"}


def planned(project: Project) -> dict[str, int]:
    run = project.snakemake("-n", "--quiet", "rules")
    assert run.status == 0, run.terminal[-3000:]
    return run.planned()


def test_nothing_changed_nothing_planned(finished: Project) -> None:
    assert planned(finished) == {}


def test_a_comment_in_the_config(copy: Project) -> None:
    copy.edit("config/test.yaml", "\ncorpora:\n", "\n# a thought\ncorpora:\n")
    assert planned(copy) == {}


def test_a_retrieval_parameter(copy: Project) -> None:
    copy.edit("config/test.yaml", "experiments:", "index:\n  reduction: mean\n\nexperiments:")
    found = planned(copy)
    assert set(found) == AFTER_RANK
    experiments = yaml.safe_load((copy.path / "config/test.yaml").read_text())["experiments"].values()
    assert found["rank"] == sum(len(e["measures"]) for e in experiments)


def test_one_take(copy: Project) -> None:
    take = sorted((copy.path / "data" / "raw" / "everyday").glob("*.bvh"))[0]
    lines = take.read_text().rstrip("\n").split("\n")
    values = lines[-1].split()
    lines[-1] = " ".join([str(float(values[0]) + 0.5), *values[1:]])
    take.write_text("\n".join(lines) + "\n")
    found = planned(copy)
    assert found["ingest"] == found["segment"] == found["features"] == 1, "one shard's chain"
    assert not set(found) & {"train", "synthesize", "lengths", "film_string", "curves", "strips"}
    assert not any(rule.startswith("perform") for rule in found)
    assert len(list((copy.path / "results" / "everyday" / "motion").glob("*.h5"))) > 1, "there are shards"


def test_a_module_of_the_library(copy: Project) -> None:
    copy.edit("src/miburi/retrieval/subspace.py", "import numpy as np", "import numpy as np  # a change")
    assert set(planned(copy)) == AFTER_RANK | {"index", "gplvm"}  # models are of the index's segments


def test_a_module_of_the_hand(copy: Project) -> None:
    copy.edit("src/miburi/hmm/windows.py", "import numpy as np", "import numpy as np  # a change")
    found = set(planned(copy))
    assert {"train", "synthesize", "lengths", "curves", "film_string"} <= found
    assert not found & {"ingest", "annotations", *BODY_CHAIN, "rank", "score"}


def test_the_report_alone(copy: Project) -> None:
    copy.edit("workflow/scripts/page.py", '"""', '"""A page: ')
    assert set(planned(copy)) == {"page", "all"}


def test_the_same_bytes_again_rerun_nothing_after(copy: Project) -> None:
    """A stage that is run again and writes the same bytes re-runs nothing in the next call."""
    motion = sorted((copy.path / "results" / "everyday" / "motion").glob("*.h5"))[0]
    motion.write_bytes(motion.read_bytes())
    assert planned(copy) == {}


HANDED_IN_ALONE = {
    "accept", "all", "animation", "annotations", "check", "curves_of", "film_take", "gplvm", "index", "left_out",
    "page", "puppeteers", "search", "search_page", "segment_lengths", "segmentation", "strips_of", "successions",
    "words",
}  # fmt: skip


def test_the_cluster_profile_groups_rules_that_there_are(finished: Project) -> None:
    """A new rule is put in a group of profiles/slurm, or named above."""
    run = finished.snakemake("--list-rules")
    rules = {line for line in run.terminal.splitlines() if line.isidentifier()}
    profile = yaml.safe_load((finished.path / "profiles/slurm/config.yaml").read_text())
    assert set(profile["groups"]) <= rules
    assert set(profile["group-components"]) <= set(profile["groups"].values())
    assert {
        rule for rule in rules - set(profile["groups"]) if not rule.startswith("perform_")
    } == HANDED_IN_ALONE


def test_no_rule_is_a_checkpoint(finished: Project) -> None:
    """Where one finishes, Snakemake asks anew what is to do, and loses jobs whose group is half done on a cluster."""
    for path in [finished.path / "Snakefile", *(finished.path / "workflow/rules").glob("*.smk")]:
        assert not re.search(r"^\s*checkpoint\b", path.read_text(), re.MULTILINE), path.name


def test_a_string_drawn_at_random_depends_on_what_models_are_trained_on(copy: Project) -> None:
    copy.edit("config/test.yaml", "strings:\n", "strings:\n  anything: {corpus: janken, random: 5}\n")
    target = "results/janken/synthesis/anything.h5"
    assert copy.snakemake(target).status == 0
    run = copy.snakemake("-n", "--quiet", "rules", "--", target)
    assert run.status == 0 and run.planned() == {}
    copy.edit("config/test.yaml", "strings:\n", "train: {floor: 0.02}\n\nstrings:\n")
    assert set(copy.snakemake("-n", "--quiet", "rules", "--", target).planned()) == {"synthesize"}
