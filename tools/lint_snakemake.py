"""`snakemake --lint` as a gate: its messages fail, but for those that the project has decided against.

All software is in one locked environment, so rules name no conda environment or container of their own.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
ALLOWED = ("Specify a conda environment or container for each rule.",)
# what --lint prints: a line "Lints for ...:", then a line "    * Title.:" and a text for each message
WHERE = re.compile(r"^Lints for (?P<where>.*):$")
MESSAGE = re.compile(r"^    \* (?P<title>.*?):?$")


def messages(text: str) -> list[tuple[str, str]]:
    """(rule or file, title of the message) of each, in order."""
    found = []
    where = "?"
    for line in text.splitlines():
        if match := WHERE.match(line):
            where = match["where"].replace(f"{ROOT}/", "")
        elif match := MESSAGE.match(line):
            found.append((where, match["title"]))
    return found


def main() -> int:
    if not (ROOT / "Snakefile").exists():
        print("no Snakefile, nothing to lint")
        return 0
    # without the profile, whose use it reports on stderr among the messages
    command = [sys.executable, "-m", "snakemake", "--lint", "--workflow-profile", "none"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    found = messages(done.stdout + done.stderr)
    bad = [f"{where}: {title}" for where, title in found if title not in ALLOWED]
    if done.returncode and not found:  # it did not get as far as its messages
        bad = [done.stdout + done.stderr]
    print("\n".join(bad) or f"snakemake --lint: nothing but {len(found)} messages that are allowed")
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
