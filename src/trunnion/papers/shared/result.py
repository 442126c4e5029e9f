"""What a reproduction gives back: figures, tables published | computed | remark, conclusions; saved as a folder."""

from __future__ import annotations

import io
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from matplotlib.figure import Figure

from trunnion._version import __version__
from trunnion.pictures.draw_matplotlib import DPI, draw
from trunnion.pictures.picture import Picture
from trunnion.reporting.pictures import address
from trunnion.results.chart import StabilityChart
from trunnion.writing import folder_written_whole

CHARTS_NOTE = (
    "Dark is unstable, as in the paper; grey, if anywhere, undecided (the spectral radius is 1 to within its error). "
    "Formulas name resonance speeds of the straight line."
)


def rounded(value: float) -> str:
    """A small number, or "rounding" where it is no more than that and differs between processors."""
    return "rounding" if abs(value) < 1e-10 else f"{value:.0e}"


@dataclass(frozen=True)
class TableRow:
    """One number: where the paper has it, what it prints, what is computed, and what is to be said."""

    place: str
    published: str
    computed: str
    remark: str = ""


@dataclass(frozen=True)
class ComparisonTable:
    """A table of rows with a title and a word on how it was computed."""

    title: str
    rows: tuple[TableRow, ...]
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
    described: Callable[[], Picture | Figure] = field(repr=False, compare=False)
    charts: tuple[StabilityChart, ...] = ()

    @property
    def file(self) -> str:
        """``figure-2.png``."""
        return f"figure-{self.number.replace(' ', '-')}.png"

    def plot(self) -> Figure:
        """The figure as the paper draws it."""
        found = self.described()
        return draw(found).figure.figure if isinstance(found, Picture) else found


CONFIRMED, CORRECTED, UNDECIDED, ADDED = "confirmed", "corrected", "not decided", "added"
LABELS = {
    CONFIRMED: "the computed figures bear it out, by more than their errors, in every reading the paper leaves open",
    CORRECTED: "they contradict it, by more than their errors, in every such reading",
    UNDECIDED: "they do neither, or they do the one in one reading and not in another",
    ADDED: "not in the paper",
}
"""What each label of a conclusion means."""
FOR, NEITHER, AGAINST = 1, 0, -1
"""What figures say of a statement."""


@dataclass(frozen=True)
class Reading:
    """One way to read a statement, or one part of what it covers: a box, a band, a base state, a range not stated.

    Parameters
    ----------
    name : which one.
    figures : what is computed for it, with numbers.
    says : whether these speak for the statement (+1) or against it (−1) by more than their errors, or neither (0).
    """

    name: str
    figures: str
    says: int

    def __post_init__(self) -> None:
        if self.says not in (FOR, NEITHER, AGAINST):
            raise ValueError(f"{self.name}: {self.says!r} is none of 1, 0, -1")
        if not re.search(r"\d", self.figures):
            raise ValueError(f"{self.name}: no number in {self.figures!r}")

    def __str__(self) -> str:
        return f"{self.name}: {self.figures}"


@dataclass(frozen=True)
class Conclusion:
    """A statement of the paper, or beside it, and the computed figures of every reading of it.

    The label ``holds`` follows from the readings alone: one that speaks otherwise than the rest leaves the statement
    undecided, and both are shown.
    """

    statement: str
    readings: tuple[Reading, ...]
    remark: str = ""
    in_paper: bool = True

    def __post_init__(self) -> None:
        names = [r.name for r in self.readings]
        if not names or len(set(names)) < len(names):
            raise ValueError(f"{self.statement!r} needs readings of different names, not {names}")

    @property
    def holds(self) -> str:
        """One of ``LABELS``."""
        if not self.in_paper:
            return ADDED
        return {FOR: CONFIRMED, AGAINST: CORRECTED, NEITHER: UNDECIDED}[agreed([r.says for r in self.readings])]

    @property
    def grounds(self) -> tuple[str, ...]:
        """Every reading with its figures, those that agree together, and the remark: a sentence or two each."""
        said = {r.says for r in self.readings}
        parts = []
        for says, words in ((FOR, "For it: "), (AGAINST, "Against it: "), (NEITHER, "Neither: ")):
            if which := [str(r) for r in self.readings if r.says == says]:
                parts.append((words if len(said) > 1 else "") + "; ".join(which) + ".")
        return (*parts, *([self.remark] if self.remark else []))

    @property
    def evidence(self) -> str:
        """The grounds in one paragraph."""
        return " ".join(self.grounds)


def agreed(signs: Sequence[int]) -> int:
    """+1 where every sign is +1, −1 where every sign is −1, else 0."""
    return FOR if all(s > 0 for s in signs) else AGAINST if all(s < 0 for s in signs) else NEITHER


def sign(holds: bool) -> int:
    """+1 or −1 of what is either so or not so."""
    return FOR if holds else AGAINST


@dataclass(frozen=True)
class Argument:
    """A proof in words and numbers: its title and its steps."""

    title: str
    steps: tuple[str, ...]

    def __str__(self) -> str:
        return "\n".join([self.title, *(f"  {i}. {step}" for i, step in enumerate(self.steps, start=1))])


@dataclass(frozen=True)
class Reproduction:
    """A paper computed anew. Print it, ``save`` it as a folder, or look at ``figures``, ``tables``, ``errata``,
    ``assumed`` (what the paper leaves open, what is taken, and what another value changes) and ``conclusions`` one by
    one."""

    name: str
    title: str
    source: str
    figures: tuple[PaperFigure, ...]
    tables: tuple[ComparisonTable, ...]
    errata: ComparisonTable
    evidence: tuple[PaperFigure, ...]
    conclusions: tuple[Conclusion, ...]
    figures_note: str = CHARTS_NOTE
    argument: Argument | None = None
    assumed: ComparisonTable | None = None

    def figure(self, number: str | int) -> PaperFigure:
        """A figure by its number in the paper."""
        return next(f for f in self.figures if f.number == str(number))

    def markdown(self) -> str:
        """The conclusions and what is assumed as tables in Markdown, as the documentation has them."""
        rows = [f"| {c.statement} | **{c.holds}** | {'<br>'.join(c.grounds)} |" for c in self.conclusions]
        table = ["| statement | | computed |", "|---|---|---|", *rows]
        if not self.assumed:
            return "\n".join(table)
        taken = [f"| {r.place} | {r.published} | {r.computed} | {r.remark} |" for r in self.assumed.rows]
        return "\n".join([*table, "", "| assumed | in the paper | taken | |", "|---|---|---|---|", *taken])

    def drawn(self) -> list[bytes]:
        """Every figure, then the evidence, as PNG."""
        return [_png(figure.plot()) for figure in (*self.figures, *self.evidence)]

    def save(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write every figure as PNG and one page with everything into ``folder``; returns the paths."""
        return _save(folder, f"{self.name}.html", (self,), lambda study: "")

    def __str__(self) -> str:
        parts = [f"{self.title}\n{self.source}"]
        parts += [str(table) for table in (*self.tables, self.errata, *([self.assumed] if self.assumed else []))]
        parts += [str(self.argument)] if self.argument else []
        parts.append(
            "Conclusions of the paper\n"
            + "\n".join(f"  {c.holds}: {c.statement}\n    {c.evidence}" for c in self.conclusions)
        )
        return "\n\n".join(parts)

    __repr__ = __str__


@dataclass(frozen=True)
class Reproductions:
    """Several papers computed anew, ``tn.reproduce("all")``: print them, or ``save`` them as one page."""

    studies: tuple[Reproduction, ...]

    def __getitem__(self, name: str) -> Reproduction:
        """A study by its name in the catalogue."""
        return next(study for study in self.studies if study.name == name)

    def save(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write ``index.html``, one page with every study and an index on top, and the figures as PNG; returns
        the paths."""
        return _save(folder, "index.html", self.studies, lambda study: f"{study.name}-")

    def __str__(self) -> str:
        return "\n\n\n".join(map(str, self.studies))

    __repr__ = __str__


def _save(
    folder: str | os.PathLike[str], first: str, studies: tuple[Reproduction, ...], prefix: Callable[[Reproduction], str]
) -> list[Path]:
    """Write the page and the pictures, whose names start with the ``prefix`` of their study."""
    drawn = [(study, study.drawn()) for study in studies]
    written = [first]
    with folder_written_whole(folder) as temporary:
        for study, pictures in drawn:
            for figure, png in zip((*study.figures, *study.evidence), pictures, strict=True):
                written.append(prefix(study) + figure.file)
                (temporary / written[-1]).write_bytes(png)
        (temporary / first).write_text(_page(drawn), encoding="utf-8", newline="\n")
    return [Path(folder) / name for name in written]


def _page(studies: Sequence[tuple[Reproduction, Sequence[bytes]]]) -> str:
    """HTML of one study or several, with an index on top; each with the PNGs of its figures and then its evidence."""
    from trunnion.reporting.page import environment

    shown = []
    for found, drawn in studies:
        addresses = [address("image/png", png) for png in drawn]
        count = len(found.figures)
        figures = list(zip(found.figures, addresses[:count], strict=True))
        shown.append((found, figures, list(zip(found.evidence, addresses[count:], strict=True))))
    template = environment("papers").get_template("reproduction.html.j2")
    return template.render(studies=shown, labels=LABELS, version=__version__)


def _png(figure: Figure) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=DPI)
    return stream.getvalue()
