"""Bad input ends in one sentence: the last line on the terminal, an exit status, no traceback, nothing half-written."""

from __future__ import annotations

from tests.workflow.conftest import Project, Run


def said(run: Run, *words: str) -> None:
    assert run.status != 0
    assert "Traceback" not in run.terminal, run.terminal[-3000:]
    for word in words:
        assert word in run.last, f"{word!r} is not in {run.last!r}"


def test_a_misspelt_key(copy: Project) -> None:
    copy.edit("config/test.yaml", "  everyday:\n    kind: body\n", "  everyday:\n    knid: body\n")
    said(copy.snakemake("-n"), "corpora.everyday", "knid", "kind")


def test_a_config_that_is_no_yaml(copy: Project) -> None:
    copy.edit("config/test.yaml", "\ncorpora:\n", "\ncorpora: [\n")
    run = copy.snakemake("-n")
    assert run.status != 0
    assert "Traceback" not in run.terminal
    assert "not valid JSON or YAML" in run.last


def test_a_wrong_path(copy: Project) -> None:
    (copy.path / "config" / "mine.yaml").write_text(
        "corpora:\n  mine:\n    kind: body\n    groups:\n      - {folder: data/nowhere, files: ['*.bvh']}\n"
    )
    said(
        copy.snakemake("--configfile=config/mine.yaml", "-n"), "corpora.mine.groups.0.folder", "data/nowhere"
    )


def test_an_unknown_label_in_a_string(copy: Project) -> None:
    copy.edit("config/test.yaml", "labels: r rs s", "labels: r rx s")
    said(copy.snakemake("results/janken/synthesis/rock_scissors_paper.h5"), "'rx'", "rs")


def test_a_truncated_bvh(copy: Project) -> None:
    take = sorted((copy.path / "data" / "raw" / "everyday").glob("*.bvh"))[0]
    text = take.read_text()
    take.write_text(text[: int(0.7 * len(text))])
    run = copy.snakemake("results/everyday/index.h5")
    said(run, take.name, "line")
    assert not list((copy.path / "results").rglob(".*tmp-*")), "nothing half-written"


def test_a_glove_log_without_a_column(copy: Project) -> None:
    log = sorted((copy.path / "data" / "raw" / "janken").glob("*.csv"))[0]
    first, header, *rest = log.read_text().splitlines()
    log.write_text(
        "\n".join([first, header.replace(",s05", ""), *(r.rsplit(",", 1)[0] for r in rest)]) + "\n"
    )
    said(copy.snakemake("results/janken/annotations.tsv"), log.name)


def test_a_puppet_log_without_a_column(copy: Project) -> None:
    folder = copy.path / "data" / "puppet"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "mine.csv").write_text("# miburi puppet log 1, fps=60\ntime_s,l_shoulder_z\n0,0\n0.017,1\n")
    said(copy.snakemake("results/everyday/search/mine.csv"), "mine.csv", "l_shoulder_x")


def test_a_damaged_artefact(copy: Project) -> None:
    index = copy.path / "results" / "everyday" / "index.h5"
    index.write_bytes(index.read_bytes()[:3000])
    run = copy.snakemake("results/everyday/scores/experiment1.csv")
    said(run, "results/everyday/index.h5")


def test_recordings_that_are_set_aside(copy: Project) -> None:
    takes = sorted((copy.path / "data" / "raw" / "everyday").glob("*.bvh"))[:2]
    for take, damage in zip(takes, (b"", b"not a recording"), strict=True):
        take.write_bytes(damage)
    copy.edit("config/test.yaml", "\ncorpora:\n", "\non_error: skip\n\ncorpora:\n")
    run = copy.snakemake("--allowed-rules", "ingest", "annotations", "--", "results/everyday/skipped.csv")
    assert run.status == 0, run.terminal[-3000:]
    skipped = (copy.path / "results/everyday/skipped.csv").read_text()
    assert all(take.stem in skipped for take in takes)
