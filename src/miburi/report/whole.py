"""The report of a run: all parts on one page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from miburi.hmm.model import Model
from miburi.hmm.splicing import Spliced
from miburi.hmm.synthesis import Synthesis
from miburi.report import assemble, hands, intervals, run
from miburi.report.assemble import Bodies, corpus_of, of_corpus
from miburi.report.pack import Clips
from miburi.report.page import Table, embedded, read_table, render
from miburi.report.words import CUTS, FIGURES, MEASURES, TABLES, columns

FILMS = 1_100_000
"""Bytes of films that the page carries itself, the smallest first; the others lie beside it."""

_BODY_TABLES, _SPEED_TABLES, _HAND_TABLES = (
    ("table1", "table2", "table3", "puppeteers"),
    ("table4", "table5"),
    ("label_counts",),
)
_PLOTS = {"table1": intervals.hits, "table2": intervals.ranks, "table3": intervals.hits}
_PARTS = (
    ("overview", "In short"),
    ("run", "What was run"),
    ("corpora", "Corpora"),
    ("segmentation", "Segmentation"),
    ("gestures", "Gestures"),
    ("models", "Models"),
    ("retrieval", "Retrieval"),
    ("searches", "Searches"),
    ("films", "Films"),
    ("more", "Further tables and figures"),
    ("speed", "Speed"),
    ("metrics", "Metrics"),
)
Paths = Sequence[str]


def report(
    given: Mapping[str, Paths],
    config: Mapping[str, Any],
    about: Mapping[str, Mapping[str, Any]],
    joints: Mapping[str, Mapping[str, Any]],
    spliced: Mapping[str, Spliced],
) -> str:
    """The report's HTML.

    Parameters
    ----------
    given
        Paths by kind, as the rule `page` names them; a kind may be absent.
    config
        The config that was run, defaults filled in.
    about
        Corpus → kind ("hand" or "body") and whether it is simulated.
    joints
        Corpus → take → names of joints, where the tables do not know them.
    spliced
        String → its labels cut from the recordings.
    """
    files = {kind: list(given.get(kind, [])) for kind in _KINDS}
    clips, numbers = Clips(), dict[str, str]()
    gestures = [_gesture(p, about, spliced, clips, numbers) for p in files["syntheses"]]
    models = [Model.open(p) for p in files["models"]]
    corpora = [_corpus(p, about) for p in files["takes"]]
    body = Bodies(clips, files["motion"], files["segments"], files["takes"], files["annotations"])
    curves = body.segmentation([c["name"] for c in corpora if c["kind"] == "body"], config["segment"], joints)
    experiments = [_experiment(p, body, files, config) for p in files["queries"]]
    packs = assemble.pack(
        gestures=gestures,
        models=hands.models(models) if models else None,
        segmentation=curves,
        retrieval={"experiments": experiments, "measure": config["search_measure"]} if experiments else None,
    )
    tables = {Path(p).stem: read_table(p, mean=_by(p)) for p in files["tables"]}
    where = {Path(p).stem: p for p in files["tables"]}
    searches, films = (
        [_search(p) for p in files["searches"] if p.endswith(".csv")],
        _films(files["films"], about),
    )
    absent = {n for n in ("segmentation", "gestures", "models", "retrieval") if n not in packs}
    more = _shown([t for t in tables if t not in TABLES], tables, where)
    pictures = [_figure(p) for p in files["figures"] if p.endswith(".png")]
    other = [f for f in pictures if f["name"] not in FIGURES]
    for name, there in (("searches", searches), ("films", films), ("more", more or other)):
        absent |= set() if there else {name}
    if any(t in tables for t in _BODY_TABLES):
        absent -= {"retrieval"}
    return render(
        "report.html",
        clips,
        packs,
        numbers,
        title="miburi: what this run made",
        contents=[p for p in _PARTS if p[0] not in absent],
        corpora=corpora,
        simulated=[c["name"] for c in corpora if c["simulated"]],
        tiles=assemble.tiles(tables, corpora, _lengths(files["lengths"])),
        versions=run.versions(),
        settings=run.settings(config),
        recordings=[(c["name"], run.recordings(of_corpus(files["motion"], c["name"]))) for c in corpora],
        corpora_table=_corpora_table(corpora),
        takes=[(corpus_of(p), read_table(p)) for p in files["takes"]],
        labels=[(corpus_of(p), assemble.labels(p)) for p in files["annotations"]],
        skipped=[(corpus_of(p), read_table(p)) for p in files["skipped"]],
        segmentation_tables=[
            (f"{corpus_of(p)}: {CUTS[Path(p).stem]}", read_table(p)) for p in files["segmentation"]
        ],
        figures=[f for f in pictures if f["name"] in FIGURES],
        more_tables=more,
        more_figures=other,
        hand_tables=_shown(_HAND_TABLES, tables, where),
        model_table=Table(hands.MODEL_COLUMNS, tuple(hands.model_rows(models))),
        measures=list(MEASURES.items()),
        body_tables=_shown(_BODY_TABLES, tables, where),
        speed_tables=_shown(_SPEED_TABLES, tables, where),
        searches=searches,
        films=films,
        benchmarks=run.benchmarks("results/benchmarks"),
        metrics=run.changes(files["metrics"][0], config["baseline"]) if files["metrics"] else Table((), ()),
        baseline=config["baseline"] if Path(config["baseline"] or "-").is_file() else "",
    )


_KINDS = (
    *(
        "tables",
        "figures",
        "films",
        "searches",
        "metrics",
        "skipped",
        "takes",
        "annotations",
        "motion",
        "segments",
    ),
    *("syntheses", "lengths", "models", "indices", "queries", "query_features", "ranks", "segmentation"),
)


def _by(path: str) -> str:
    return {"label_counts": "label", "puppeteers": "query"}.get(Path(path).stem, "keyword")


def _corpus(path: str, about: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    rows, name = assemble.read_rows(path), corpus_of(path)
    return {
        "name": name,
        **about[name],
        "takes": len(rows),
        "subjects": len({r["subject"] for r in rows}),
        "seconds": sum(float(r["seconds"]) for r in rows),
    }


def _corpora_table(corpora: Sequence[Mapping[str, Any]]) -> Table:
    rows = tuple(
        (
            c["name"],
            "hands" if c["kind"] == "hand" else "bodies",
            "simulated" if c["simulated"] else "recorded",
            str(c["subjects"]),
            str(c["takes"]),
            f"{c['seconds']:.1f}",
        )
        for c in corpora
    )
    return Table(("corpus", "of", "people", "subjects", "takes", "seconds"), rows)


def _gesture(
    path: str,
    about: Mapping[str, Mapping[str, Any]],
    spliced: Mapping[str, Spliced],
    clips: Clips,
    numbers: dict[str, str],
) -> dict[str, Any]:
    name, source = Path(path).stem, "simulated" if about[corpus_of(path)]["simulated"] else "recorded"
    return hands.gesture(name, Synthesis.open(path), spliced.get(name), source, clips, numbers)


def _experiment(
    table: str, body: Bodies, files: Mapping[str, Paths], config: Mapping[str, Any]
) -> dict[str, Any]:
    """An experiment by the path of its queries, data/raw/{corpus}/queries/{experiment}/queries.tsv."""
    corpus, name = Path(table).parts[-4], Path(table).parts[-2]
    features = next(p for p in of_corpus(files["query_features"], corpus) if Path(p).stem == name)
    ranks = [p for p in of_corpus(files["ranks"], corpus) if Path(p).parts[-2] == name]
    index = of_corpus(files["indices"], corpus)[0]
    return body.experiment(name, corpus, index, table, features, ranks, config["search_measure"])


def _lengths(paths: Paths) -> dict[str, str]:
    return {r["quantity"]: r["value"] for r in assemble.read_rows(paths[0])} if paths else {}


def _figure(path: str) -> dict[str, str]:
    name = Path(path).stem
    title, words = FIGURES.get(name, (name.replace("_", " "), ""))
    return {"name": name, "data": embedded(path), "alt": title, "words": words}


def _shown(
    names: Sequence[str], tables: Mapping[str, Table], where: Mapping[str, str]
) -> list[dict[str, Any]]:
    return [
        {
            "name": name,
            "title": TABLES.get(name, (name.replace("_", " "), ""))[0],
            "words": TABLES.get(name, (name, ""))[1],
            "path": where[name],
            "table": tables[name],
            "columns": columns(tables[name].columns) if "ranks" in tables[name].columns else [],
            "plots": _PLOTS[name](tables[name].records()) if name in _PLOTS else [],
        }
        for name in names
        if name in tables
    ]


def _search(path: str) -> dict[str, Any]:
    name, corpus = Path(path).stem, corpus_of(path)
    return {
        "name": name,
        "corpus": corpus,
        "link": f"{corpus}/search/{name}.html",
        "table": read_table(path, 10),
    }


def _films(paths: Paths, about: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    films = [p for p in paths if p.endswith(".mp4")]
    inside, room = set(), FILMS
    for path in sorted(films, key=lambda p: (Path(p).stat().st_size, p)):
        room -= Path(path).stat().st_size
        if room >= 0:
            inside.add(path)
    found = []
    for path in films:
        carried = path in inside
        kind = "simulated" if about[corpus_of(path)]["simulated"] else "recorded"
        compared = ": a take, put end to end, and generated" if "compared" in Path(path).parts else ""
        sheet = path.replace(".mp4", "_sheet.png")
        found.append(
            {
                "source": embedded(path) if carried else str(Path(path).relative_to("results")),
                "inside": carried,
                "alt": f"{Path(path).stem.replace('_', ' ')}, from {kind} {corpus_of(path)}{compared}",
                "sheet": embedded(sheet) if carried and Path(sheet).is_file() and sheet in paths else "",
            }
        )
    return found
