"""Writes docs/data/printed_numbers.json: printed numbers whose computed ones take long, with date and version.

PYTHONPATH=src:tests python docs/data/printed_numbers.py
"""

from __future__ import annotations

import json
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from published.cases import BATCHES

import trunnion as tn

DATA = Path(__file__).with_suffix(".json")

if __name__ == "__main__":
    found: dict[str, Any] = {}
    for batch in BATCHES:
        if batch.slow:
            begin = time.process_time()
            rows = [
                {"what": r.what, "printed": r.printed, "computed": r.computed, "verdict": r.verdict.value}
                for r in batch.rows()
            ]
            found[f"{batch.source}: {batch.where}"] = {
                "rows": rows,
                "on": datetime.now(UTC).date().isoformat(),
                "version": tn.__version__,
                "seconds": round(time.process_time() - begin, 1),
            }
    part = DATA.with_name(DATA.name + ".part")
    part.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    part.replace(DATA)
