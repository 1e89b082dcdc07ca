"""What happens in a corpus of hands → which label follows which, and how often."""

import csv

from miburi import job, store
from miburi.hands import read_intervals
from miburi.strings import successions


def main(snakemake):
    found = successions(list(read_intervals(snakemake.input[0]).values()))
    with store.replaced(snakemake.output[0]) as path, open(path, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["label", "follower", "times"])
        table.writerows(found)


job.run(main, snakemake)  # noqa: F821
