"""``tn.reproduce``: which papers can be computed anew."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Literal, overload

from trunnion.errors import InputError
from trunnion.papers.shared.result import Reproduction, Reproductions

PAPERS = {
    "two-shaft-cardan": "trunnion.papers.two_shaft_cardan.study:two_shaft_cardan",
    "bicardan-elastic": "trunnion.papers.bicardan_elastic.study:bicardan_elastic",
    "three-shaft-cardan": "trunnion.papers.three_shaft_cardan.study:three_shaft_cardan",
    "double-tripod": "trunnion.papers.double_tripod.study:double_tripod",
    "gear-rattle": "trunnion.papers.gear_rattle.study:gear_rattle",
}
"""Catalogue names that have a reproduction, and the function that makes it of ``points`` and of what tells the share
done."""


ALL = "all"


@overload
def reproduce(  # type: ignore[overload-overlap]
    name: Literal["all"], *, points: int = 400, progress: Callable[[float], None] | None = None
) -> Reproductions: ...


@overload
def reproduce(name: str, *, points: int = 400, progress: Callable[[float], None] | None = None) -> Reproduction: ...


def reproduce(
    name: str, *, points: int = 400, progress: Callable[[float], None] | None = None
) -> Reproduction | Reproductions:
    """Compute the figures, tables and conclusions of a published paper anew.

    Parameters
    ----------
    name : of the catalogue: "two-shaft-cardan", "bicardan-elastic", "three-shaft-cardan", "double-tripod" or
        "gear-rattle"; or "all".
    points : of the charts, along each axis.
    progress : called as progress(share done).

    Returns
    -------
    Reproduction with ``figures``, ``tables`` (published | computed | remark), ``errata`` and ``conclusions``;
    ``save(folder)`` writes pictures and one page. For "all" a ``Reproductions`` of every study, whose ``save`` writes
    one page with an index on top.

    Raises
    ------
    InputError : no such paper.

    Examples
    --------
    >>> import trunnion as tn
    >>> found = tn.reproduce("gear-rattle", points=50)
    >>> found.tables[0].title
    'Methods against the exact motion, B₀ = 0.05 (half peak-to-peak, ω)'
    """
    if name != ALL and name not in PAPERS:
        known = ", ".join((*PAPERS, ALL))
        raise InputError("has no reproduction", key=str(name), remedy=f"there are: {known}")
    if isinstance(points, bool) or not isinstance(points, int) or points < 50:
        raise InputError("must be a whole number, 50 or more", key="points", value=points)
    if name != ALL:
        return _one(name, points, progress)
    report_progress = progress or (lambda share: None)
    count = len(PAPERS)

    def part(done: int) -> Callable[[float], None]:
        return lambda share: report_progress((done + share) / count)

    return Reproductions(tuple(_one(paper, points, part(i)) for i, paper in enumerate(PAPERS)))


def _one(name: str, points: int, progress: Callable[[float], None] | None) -> Reproduction:
    module, function = PAPERS[name].split(":")
    report_progress = progress or (lambda share: None)
    made: Reproduction = getattr(import_module(module), function)(points, report_progress)
    report_progress(1.0)
    return made
