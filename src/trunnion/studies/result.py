"""What a reproduction gives back: figures, tables published | computed | remark, conclusions; saved as a folder."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from trunnion.results.chart import StabilityChart
from trunnion.writing import folder_written_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure


CHARTS_NOTE = (
    "Dark is unstable, as in the paper; grey, if anywhere, undecided (the spectral radius is 1 to within its error). "
    "Formulas name resonance speeds of the straight line."
)


@dataclass(frozen=True)
class Row:
    """One number: where the paper has it, what it prints, what is computed, and what is to be said."""

    place: str
    published: str
    computed: str
    remark: str = ""


@dataclass(frozen=True)
class Comparison:
    """A table of rows with a title and a word on how it was computed."""

    title: str
    rows: tuple[Row, ...]
    note: str = ""

    def __str__(self) -> str:
        heads = ("", "published", "computed", "remark")
        cells = [heads, *((r.place, r.published, r.computed, r.remark) for r in self.rows)]
        widths = [max(len(row[i]) for row in cells) for i in range(3)]
        lines = ["  " + "  ".join(f"{row[i]:<{widths[i]}}" for i in range(3)) + f"  {row[3]}" for row in cells]
        return "\n".join([self.title, *(line.rstrip() for line in lines), *([f"  {self.note}"] if self.note else [])])


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper computed anew: number, what it shows, what was assumed, its charts."""

    number: str
    caption: str
    assumed: str
    charts: tuple[StabilityChart, ...]
    draw: Callable[[], Figure] = field(repr=False, compare=False)

    @property
    def file(self) -> str:
        """``figure-2.png``."""
        return f"figure-{self.number.replace(' ', '-')}.png"

    def plot(self) -> Figure:
        """The figure as the paper draws it."""
        return self.draw()


@dataclass(frozen=True)
class Conclusion:
    """A statement of the paper, whether it holds, and the computed figures that say so."""

    statement: str
    holds: str
    evidence: str


@dataclass(frozen=True)
class Reproduction:
    """A paper computed anew. Print it, ``save`` it as a folder, or look at ``figures``, ``tables``,
    ``errata`` and ``conclusions`` one by one."""

    name: str
    title: str
    source: str
    figures: tuple[PaperFigure, ...]
    tables: tuple[Comparison, ...]
    errata: Comparison
    evidence: tuple[PaperFigure, ...]
    conclusions: tuple[Conclusion, ...]
    figures_note: str = CHARTS_NOTE

    def figure(self, number: str | int) -> PaperFigure:
        """A figure by its number in the paper."""
        return next(f for f in self.figures if f.number == str(number))

    def save(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write every figure as PNG and one page with everything into ``folder``; returns the paths."""
        from trunnion.plots.style import DPI
        from trunnion.studies.page import page

        drawn = [(figure, figure.plot()) for figure in (*self.figures, *self.evidence)]
        first = f"{self.name}.html"
        with folder_written_whole(folder) as temporary:
            for figure, picture in drawn:
                picture.savefig(temporary / figure.file, format="png", dpi=DPI)
            text = page(self, [picture for _, picture in drawn])
            (temporary / first).write_text(text, encoding="utf-8", newline="\n")
        return [Path(folder) / name for name in (first, *(figure.file for figure, _ in drawn))]

    def __str__(self) -> str:
        parts = [f"{self.title}\n{self.source}"]
        parts += [str(table) for table in (*self.tables, self.errata)]
        parts.append(
            "Conclusions of the paper\n"
            + "\n".join(f"  {c.holds}: {c.statement}\n    {c.evidence}" for c in self.conclusions)
        )
        return "\n\n".join(parts)

    __repr__ = __str__
