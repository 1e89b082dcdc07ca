"""The papers' printed tables: [H]'s table 2 as `label_counts`, [P]'s tables 1 to 5."""

from __future__ import annotations

import csv
from importlib import resources

STRING = "r rs s sp p pr r rp p ps s sr r"
"""The string of labels that [H] synthesises."""

LENGTH = 238
"""Frames of that string, as printed."""

SEGMENTS = {"table1": 269, "table2": 269, "table3": 3065, "table4": 269, "table5": 3065}
"""Segments that [P] ranks in each table's experiment."""


def table(name: str) -> list[dict[str, str]]:
    """Rows of a printed table.

    Parameters
    ----------
    name
        "label_counts" or "table1" … "table5".
    """
    text = resources.files(__name__).joinpath(f"{name}.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))
