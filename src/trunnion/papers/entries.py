"""The list of published drivelines: name, title, source, and how to build each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, overload

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.papers.bicardan_elastic.published import bicardan_elastic
from trunnion.papers.three_shaft_cardan.published import three_shaft_cardan
from trunnion.papers.two_shaft_cardan.published import two_shaft_cardan

if TYPE_CHECKING:
    from trunnion.papers.double_tripod.published import DoubleTripod
    from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


@dataclass(frozen=True)
class Entry:
    """A published driveline: ``build()`` gives the paper's base case, keyword arguments change it.

    ``double-tripod`` builds equations of motion (a ``DoubleTripod``), ``gear-rattle`` a ``PiecewiseOscillator``, the
    others a ``Driveline`` (``describes_line``).
    """

    name: str
    title: str
    source: str
    build: Callable[..., Driveline | DoubleTripod | PiecewiseOscillator]
    describes_line: bool = True


def _double_tripod(**changes: Any) -> DoubleTripod:
    from trunnion.papers.double_tripod.published import double_tripod  # it brings the kernels with it

    return double_tripod(**changes)


def _gear_rattle(**changes: Any) -> PiecewiseOscillator:
    from trunnion.papers.gear_rattle.published import gear_rattle  # the same

    return gear_rattle(**changes)


_ENTRIES = (
    Entry(
        "two-shaft-cardan",
        "two shafts and a Hooke's joint, nondimensional",
        "Soltan Rezaee and Ghazavi, Modares Mechanical Engineering 14 (12), 2014, 163–170 (in Persian)",
        two_shaft_cardan,
    ),
    Entry(
        "three-shaft-cardan",
        "three shafts and two Hooke's joints, nondimensional",
        "Soltan Rezaee and co-authors, Modares Mechanical Engineering 12 (in Persian)",
        three_shaft_cardan,
    ),
    Entry(
        "bicardan-elastic",
        "two Hooke's joints and an elastic shaft between them, for kinetostatics",
        "Săulescu, Bercan and Hudan, Dynamic modeling of cardan transmissions in modular variant III, 2007",
        bicardan_elastic,
    ),
    Entry(
        "double-tripod",
        "double tripod industrial driveshaft: equations of its two outer elements",
        "Bugaru and Vasile, Applied Sciences 12 (2022) 6182",
        _double_tripod,
        describes_line=False,
    ),
    Entry(
        "gear-rattle",
        "gear pair with backlash as one equation, nondimensional",
        "M. Rezaee and A. Farshidianfar, multiple scales and averaging for gear rattle (in Persian)",
        _gear_rattle,
        describes_line=False,
    ),
)


def entries() -> tuple[Entry, ...]:
    """All entries of the catalogue."""
    return _ENTRIES


@overload
def catalogue(name: Literal["double-tripod"], **changes: Any) -> DoubleTripod: ...  # type: ignore[overload-overlap]


@overload
def catalogue(name: Literal["gear-rattle"], **changes: Any) -> PiecewiseOscillator: ...  # type: ignore[overload-overlap]


@overload
def catalogue(name: str, **changes: Any) -> Driveline: ...


def catalogue(name: str, **changes: Any) -> Driveline | DoubleTripod | PiecewiseOscillator:
    """A published driveline by name; keyword arguments change its numbers (see the entry's builder).

    Parameters
    ----------
    name : of the entry, as "two-shaft-cardan".
    **changes : new values of its numbers, in its own units; see the entry's builder.

    Raises
    ------
    InputError : no such entry (the nearest is suggested), or a keyword it does not have.

    Examples
    --------
    >>> import trunnion as tn
    >>> tn.catalogue("two-shaft-cardan", angle=0.2).names[3]
    'HookeJoint 1'
    """
    for entry in _ENTRIES:
        if entry.name == name:
            try:
                return entry.build(**changes)
            except TypeError as error:
                raise InputError(str(error).split(") ", 1)[-1], element=name, remedy="see help(tn.catalogue)") from None
    raise InputError("is not in the catalogue", key=name, remedy=nearest(name, [e.name for e in _ENTRIES]))
