"""Printed numbers of others beside computed ones: what was read, the figures as printed, and the verdict.

Each stands once, in ``tests/published/cases``. ``test_numbers.py`` holds every verdict, and the page *Validation* of
the site prints the same rows.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum


class Verdict(Enum):
    """What a printed number and a computed one are to each other."""

    AGREES = "agrees"
    ROUNDING = "within rounding"
    PRECISION = "within its precision"
    SOURCE = "source in error"
    UNDECIDED = "not decided"
    DISPUTED = "disputed"
    DIFFERS = "differs"


@dataclass(frozen=True)
class Source:
    """Who printed it, and what of it was read: the work itself, or another's account of it."""

    title: str
    read: str


@dataclass(frozen=True)
class Row:
    """One number: as printed, as computed, and what follows."""

    what: str
    printed: str
    computed: float
    verdict: Verdict
    because: str = ""

    @property
    def difference(self) -> float:
        """Computed minus printed."""
        return self.computed - value(self.printed)


@dataclass(frozen=True)
class Batch:
    """Numbers of one table or figure that are computed together.

    Attributes
    ----------
    source : key of ``SOURCES``.
    where : page, table or figure.
    unit : of all of them.
    printed : text of each number as it stands there, by what it is.
    compute : all of them in that order.
    relative, absolute : precision that the source states, or a drawing has, where it is coarser than the last figure.
    precision : why.
    judged : verdict and reason of those that do not agree.
    otherwise : verdict and reason of all others that do not agree, where a whole table inherits one fault.
    slow : takes more than a second or two.
    """

    source: str
    where: str
    unit: str
    printed: Mapping[str, str]
    compute: Callable[[], Sequence[float]]
    relative: float = 0.0
    absolute: float = 0.0
    precision: str = ""
    judged: Mapping[str, tuple[Verdict, str]] = field(default_factory=dict)
    otherwise: tuple[Verdict, str] = (Verdict.DIFFERS, "")
    slow: bool = False

    def rows(self) -> list[Row]:
        """Every number, computed now."""
        computed = [float(one) for one in self.compute()]
        assert len(computed) == len(self.printed), (self.where, len(computed))
        return [self._row(what, text, one) for (what, text), one in zip(self.printed.items(), computed, strict=True)]

    def _row(self, what: str, text: str, computed: float) -> Row:
        off = abs(computed - value(text))
        allowed = max(self.absolute, self.relative * abs(value(text)))
        if what in self.judged:
            verdict, because = self.judged[what]
            return Row(what, text, computed, verdict, because)
        if value(text) == 0.0:  # printed as exactly nothing: no figures to round to
            return Row(what, text, computed, Verdict.AGREES if off <= allowed else Verdict.DIFFERS)
        if off <= 0.501 * last_place(text):
            return Row(what, text, computed, Verdict.AGREES)
        if off <= 1.001 * last_place(text):
            return Row(what, text, computed, Verdict.ROUNDING)
        if off <= allowed:
            return Row(what, text, computed, Verdict.PRECISION, self.precision)
        return Row(what, text, computed, *self.otherwise)


def value(printed: str) -> float:
    """The number a text stands for."""
    return float(printed)


def last_place(printed: str) -> float:
    """One unit of the last figure that is printed: 0.01 of "3.14", 10 of "3.2e2"."""
    found = re.fullmatch(r"[+-]?(\d*)\.?(\d*)(?:[eE]([+-]?\d+))?", printed)
    assert found, printed
    return 10.0 ** (int(found[3] or 0) - len(found[2]))
