"""``tn.reproduce``: which papers can be computed anew."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from trunnion.errors import InputError
from trunnion.studies.result import Reproduction

PAPERS = {
    "two-shaft-cardan": "trunnion.studies.two_shaft_cardan.study:two_shaft_cardan",
    "three-shaft-cardan": "trunnion.studies.three_shaft_cardan.study:three_shaft_cardan",
    "double-tripod": "trunnion.studies.double_tripod.study:double_tripod",
    "gear-rattle": "trunnion.studies.gear_rattle.study:gear_rattle",
}
"""Catalogue names that have a reproduction, and the function that makes it."""


def reproduce(name: str, *, points: int = 400, progress: Callable[[float], None] | None = None) -> Reproduction:
    """Compute the figures, tables and conclusions of a published paper anew.

    Parameters
    ----------
    name : of the catalogue: "two-shaft-cardan", "three-shaft-cardan", "double-tripod" or "gear-rattle".
    points : of the charts, along each axis.
    progress : called as progress(share done).

    Returns
    -------
    Reproduction with ``figures``, ``tables`` (published | computed | remark), ``errata`` and ``conclusions``;
    ``save(folder)`` writes pictures and one page.

    Raises
    ------
    InputError : no such paper.
    """
    if name not in PAPERS:
        known = ", ".join(PAPERS)
        raise InputError("has no reproduction", key=str(name), remedy=f"there are: {known}")
    if isinstance(points, bool) or not isinstance(points, int) or points < 50:
        raise InputError("must be a whole number, 50 or more", key="points", value=points)
    module, function = PAPERS[name].split(":")
    made: Reproduction = getattr(import_module(module), function)(points=points, progress=progress)
    return made
