"""Writes what follows from the config's model: its JSON schema and the table of keys in config/README.md.

python tools/config_docs.py            # write
python tools/config_docs.py --check    # fail if they are out of date
"""

import json
import sys
from pathlib import Path

from miburi import config

ROOT = Path(__file__).parents[1]
SCHEMA = ROOT / "workflow" / "schemas" / "config.schema.json"
README = ROOT / "config" / "README.md"
BEGIN, END = "<!-- keys -->\n", "<!-- end of keys -->\n"


def table() -> str:
    rows = ["| key | default | meaning |", "|---|---|---|"]
    for key, default, meaning in config.all_keys():
        shown = f"`{default}`" if default else ""
        rows.append(f"| `{key}` | {shown} | {meaning.replace('|', '&#124;')} |")
    return "\n".join(rows) + "\n"


def files() -> dict[Path, str]:
    text = README.read_text(encoding="utf-8")
    before, _, rest = text.partition(BEGIN)
    after = rest.partition(END)[2]
    return {
        SCHEMA: json.dumps(config.schema(), indent=2, ensure_ascii=False) + "\n",
        README: f"{before}{BEGIN}\n{table()}\n{END}{after}",
    }


def main() -> int:
    stale = [p for p, text in files().items() if not p.exists() or p.read_text(encoding="utf-8") != text]
    if "--check" in sys.argv:
        for path in stale:
            print(
                f"{path.relative_to(ROOT)} is out of date; run python tools/config_docs.py", file=sys.stderr
            )
        return int(bool(stale))
    for path, text in files().items():
        path.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
