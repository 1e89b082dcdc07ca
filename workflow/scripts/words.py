"""A string of the config, or one drawn from the successions of a corpus → its words, all of which can be had."""

import csv
import zlib

from miburi import job, store
from miburi.errors import InputError
from miburi.hands import read_intervals
from miburi.strings import Succession, draw, parse, untrainable


def main(snakemake):
    lengths = {}
    for intervals in read_intervals(snakemake.input.annotations).values():
        for start, end, label in intervals:
            lengths.setdefault(label, []).append(end - start)
    with open(snakemake.input.successions, encoding="utf-8", newline="") as file:
        pairs = [Succession(r["label"], r["follower"], int(r["times"])) for r in csv.DictReader(file)]
    p, name = snakemake.params.string, snakemake.wildcards.string
    string = p["labels"] or draw(pairs, p["random"], [p["seed"], zlib.crc32(name.encode())])
    words = parse(string, lengths, pairs if p["pairs"] == "recorded" else None)
    needed = {word.label: lengths[word.label] for word in words}
    if wrong := untrainable(needed, p["states"], p["exit"], p["least_intervals"]):
        raise InputError(
            "; ".join(f"label {label!r} cannot be trained: {why}" for label, why in wrong.items())
        )
    store.write_text(snakemake.output[0], " ".join(word.text for word in words) + "\n")


job.run(main, snakemake)  # noqa: F821
