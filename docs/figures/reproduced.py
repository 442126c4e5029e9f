"""Writes the tables of conclusions in docs/reproduced.md from the studies themselves.

PYTHONPATH=src python docs/figures/reproduced.py [NAME …]
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import trunnion as tn
from trunnion.papers.reproduce import PAPERS

PAGE = Path(__file__).parents[1] / "reproduced.md"

if __name__ == "__main__":
    for name in sys.argv[1:] or PAPERS:
        table = tn.reproduce(name).markdown()
        text = PAGE.read_text(encoding="utf-8")
        found = re.compile(rf"<!-- {name} -->\n.*?<!-- end of {name} -->", re.DOTALL)
        block = f"<!-- {name} -->\n\n{table}\n\n<!-- end of {name} -->"
        [old] = found.findall(text)
        PAGE.write_text(text.replace(old, block), encoding="utf-8")
