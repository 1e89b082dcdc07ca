"""Everything that a run has made → one page."""

import csv
from pathlib import Path

from miburi import job, store
from miburi.report.page import Corpus, Film, Picture, Section, embedded, page, read_table
from miburi.report.words import FIGURES, TABLES

MOST = 3_000_000  # bytes of films that the page carries itself


def corpus(path, about):
    with open(path, encoding="utf-8", newline="") as file:
        takes = list(csv.DictReader(file))
    return Corpus(
        Path(path).parent.name, **about, takes=len(takes), seconds=sum(float(t["seconds"]) for t in takes)
    )


def main(snakemake):
    given, sections = snakemake.input, []
    for path in given.figures:
        title, words = FIGURES[Path(path).stem]
        sections.append(
            Section(Path(path).stem, title, words, path, pictures=(Picture(embedded(path), title),))
        )
    films = [p for p in given.films if p.endswith(".mp4")]
    carried = sum(Path(p).stat().st_size for p in films) <= MOST
    for path in films:
        name, sheet = Path(path).stem, path.replace(".mp4", "_sheet.png")
        source = embedded(path) if carried else str(Path(path).relative_to("results"))
        alt, words = f"{name} of {Path(path).parts[-3]}", "The film, and pictures from it."
        pictures = (Picture(embedded(sheet), f"pictures of {alt}"),)
        sections.append(
            Section(f"film-{name}", f"Film: {alt}", words, path, None, pictures, (Film(source, alt),))
        )
    for path in given.tables:
        title, words = TABLES[Path(path).stem]
        by = {"label_counts": "label", "puppeteers": "query"}.get(Path(path).stem, "keyword")
        sections.append(Section(Path(path).stem, title, words, path, read_table(path, mean=by)))
    for path in given.searches:
        name, where = Path(path).stem, Path(path).parts[-3]
        words = "The ten segments that are nearest to this log."
        sections.append(
            Section(f"search-{where}-{name}", f"Search: {name} in {where}", words, path, read_table(path, 10))
        )
    for path in given.skipped:
        table = read_table(path)
        if table.rows:
            name = Path(path).parent.name
            words = "Recordings that cannot be read."
            sections.append(Section(f"skipped-{name}", f"Set aside in {name}", words, path, table))
    about = snakemake.params.corpora
    corpora = [corpus(path, about[Path(path).parent.name]) for path in given.takes]
    store.write_text(snakemake.output[0], page(sections, corpora))


job.run(main, snakemake)  # noqa: F821
