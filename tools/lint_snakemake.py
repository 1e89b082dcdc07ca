"""`snakemake --lint` as a gate: its messages fail, but for those that the project has decided against.

All software is in one locked environment, so rules name no conda environment or container of their own.
"""

from __future__ import annotations

import json
import subprocess
import sys

ALLOWED = ("Specify a conda environment or container for each rule.",)


def main() -> int:
    done = subprocess.run(
        [sys.executable, "-m", "snakemake", "--lint", "json"], capture_output=True, text=True, check=False
    )
    start = done.stdout.find("{")
    if start < 0:
        print(done.stdout + done.stderr, file=sys.stderr)
        return 1
    found = json.loads(done.stdout[start:])
    messages = [("Snakefile", lint) for lint in found.get("snakefiles", [])]
    messages += [(rule["name"], lint) for rule in found.get("rules", []) for lint in rule["lints"]]
    messages += [(file.get("path", ""), lint) for file in found.get("files", []) for lint in file["lints"]]
    bad = [(where, lint) for where, lint in messages if lint["title"] not in ALLOWED]
    for where, lint in bad:
        print(f"{where}: {lint['title']}: {lint['body']}", file=sys.stderr)
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
