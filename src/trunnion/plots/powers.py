"""Powers of ten at logarithmic axes as text: typesetting them as mathematics takes longer than all other text."""

from __future__ import annotations

import re
from typing import Any

from matplotlib.ticker import LogFormatterSciNotation

RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


class PlainPowers(LogFormatterSciNotation):
    """The numbers that matplotlib writes there by default, as 10⁻³ and 2×10⁴ in plain characters."""

    def __call__(self, x: float, pos: Any = None) -> str:
        """The label of a tick at ``x``."""
        return plain_power(str(super().__call__(x, pos)))


def plain_power(text: str) -> str:
    """``$\\mathdefault{2\\times10^{4}}$`` → 2×10⁴."""
    inner = re.fullmatch(r"\$\\mathdefault\{(.*)\}\$", text)
    if inner is None:
        return text
    said = inner[1].replace(r"\times", "×")
    return re.sub(r"\^\{(-?\d+)\}", lambda found: found[1].translate(RAISED), said)
