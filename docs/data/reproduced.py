"""Writes docs/data/reproduced.json: tables, errata and conclusions of every study, with date and version.

PYTHONPATH=src python docs/data/reproduced.py [NAME …]       # all take some minutes
"""

from __future__ import annotations

import json
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import trunnion as tn
from trunnion.papers.reproduce import PAPERS

DATA = Path(__file__).with_suffix(".json")


def told(name: str) -> dict[str, Any]:
    """What one study says, as plain values."""
    begin = time.process_time()
    found = tn.reproduce(name)
    return {
        "title": found.title,
        "source": found.source,
        "tables": [
            {"title": table.title, "rows": [[r.place, r.published, r.computed, r.remark] for r in table.rows]}
            for table in found.tables
        ],
        "errata": [[r.place, r.published, r.computed, r.remark] for r in found.errata.rows],
        "conclusions": [[c.statement, c.holds] for c in found.conclusions],
        "figures": [[f.number, f.caption] for f in found.figures],
        "seconds": round(time.process_time() - begin, 1),
    }


def write(data: dict[str, Any]) -> None:
    """Beside, then in place."""
    part = DATA.with_name(DATA.name + ".part")
    part.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    part.replace(DATA)


if __name__ == "__main__":
    known = json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {}
    for name in sys.argv[1:] or PAPERS:
        known[name] = {**told(name), "on": datetime.now(UTC).date().isoformat(), "version": tn.__version__}
        write(known)
