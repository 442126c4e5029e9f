"""The two ways a request can fail, and the remark that does not stop it.

Every message is one line that names the element, the key, the value and the remedy; the command line
prints it as it stands and turns the class into an exit code (2 for bad input, 1 for a failed computation).
"""

from __future__ import annotations

import os
import reprlib
from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeVar

Made = TypeVar("Made")
MOST_LINES = 20
"""Most complaints that the text of one error lists."""
MOST_ALIKE = 3
"""Complaints that differ in their place and value alone which are written out of many."""
LONGEST = 80
"""Most characters of what a user wrote that a message quotes in one piece."""


class TrunnionError(Exception):
    """Base of every error this package raises on purpose."""

    exit_code = 1


class InputError(TrunnionError, ValueError):
    """Something the caller wrote cannot be used; says where, what, and what to write instead.

    Parameters
    ----------
    problem : what is wrong, as half a sentence ("must be positive").
    element, key : where it stands, e.g. "Shaft 1" and "stiffness"; either may be empty.
    value : the offending value, shown with ``repr``-like brevity.
    remedy : what to do about it ("write 1.2e4 or \"12 kN*m/rad\"").

    ``problems`` are the single complaints: itself, or all of them where several were found at once
    (``together``), whose text then has a line each.

    >>> print(InputError("must be positive", element="Shaft 1", key="stiffness", value=-1.0))
    Shaft 1.stiffness = -1: must be positive
    """

    exit_code = 2

    def __init__(
        self,
        problem: str,
        *,
        element: str = "",
        key: str = "",
        value: object = None,
        remedy: str = "",
    ) -> None:
        self.problem = problem
        self.element = element
        self.key = key
        self.value = value
        self.remedy = remedy
        self.problems: tuple[InputError, ...] = (self,)
        super().__init__(self.sentence())

    @staticmethod
    def together(problems: Iterable[InputError]) -> InputError:
        """All of ``problems`` as one error, the first speaking for all where one complaint is asked for."""
        single = tuple(one for problem in problems for one in problem.problems)
        first = single[0]
        if len(single) == 1:
            return first
        whole = first.but()
        whole.problems = single
        lines = list(_lines(single))
        more = [f"and {len(lines) - MOST_LINES} more"] if len(lines) > MOST_LINES else []
        whole.args = ("\n".join([*lines[:MOST_LINES], *more]),)
        return whole

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        # What is pickled by default is the text alone, taken for the problem.
        parts = [(one.problem, one.element, one.key, _portable(one.value), one.remedy) for one in self.problems]
        return _together, (parts,)

    def each(self, change: Callable[[InputError], InputError]) -> InputError:
        """The same error with every single complaint changed."""
        return InputError.together([change(one) for one in self.problems])

    def but(self, **changes: Any) -> InputError:
        """This complaint with its ``element``, ``key``, ``value``, ``problem`` or ``remedy`` changed."""
        stated = {"element": self.element, "key": self.key, "value": self.value, "remedy": self.remedy}
        return InputError(changes.pop("problem", self.problem), **{**stated, **changes})

    @property
    def place(self) -> str:
        """Element and key, each cut where it is long."""
        return ".".join(short(part) for part in (self.element, self.key) if part)

    def sentence(self) -> str:
        """The whole message on one line."""
        place = self.place
        shown = "" if self.value is None else f" = {_brief(self.value)}"
        head = f"{place}{shown}: " if place or shown else ""
        tail = f"; {self.remedy}" if self.remedy else ""
        return " ".join(f"{head}{self.problem}{tail}".split())


def _lines(problems: Iterable[InputError]) -> Iterator[str]:
    """A line each, once; of many that differ in their place and value alone the first, and how many more."""
    every = {str(one): one for one in problems}
    alike: dict[tuple[str, str, str], list[InputError]] = {}
    for one in every.values():
        alike.setdefault((one.problem, one.key, one.remedy), []).append(one)
    for line, one in every.items():
        same = alike[one.problem, one.key, one.remedy]
        place, folded = same.index(one), len(same) > MOST_ALIKE + 1
        if place < MOST_ALIKE or not folded:
            yield line
        if folded and place == MOST_ALIKE:
            yield f"and {len(same) - MOST_ALIKE} more of the same, the last at {same[-1].place}"


class NothingToDraw(InputError):
    """A result without a picture, which only matters where one was asked for."""


class ComputationError(TrunnionError, RuntimeError):
    """The input was fine and the computation still failed; says at which point and which knob to turn.

    >>> ComputationError("did not settle; raise most_steps").exit_code
    1
    """

    exit_code = 1


class InputRemark(UserWarning):
    """The input is accepted, but a colleague would ask whether it is meant.

    >>> import warnings, trunnion as tn
    >>> with warnings.catch_warnings(record=True) as remarks:
    ...     warnings.simplefilter("always", tn.InputRemark)
    ...     _ = tn.Shaft(stiffness=1e4, damping=-1.0)
    >>> print(remarks[0].message)
    Shaft.damping = -1: is negative and feeds energy into the line; write it positive unless that is meant
    """


def short(text: str, limit: int = LONGEST) -> str:
    """``text``, cut where it is longer than a line wants: at its end, a path at its beginning: its end names a file."""
    if len(text) <= limit:
        return text
    return "…" + text[1 - limit :] if os.path.isabs(text) and "\n" not in text else text[: limit - 1] + "…"


def all_made(makers: Iterable[Callable[[], Made]]) -> list[Made]:
    """What each of ``makers`` gives.

    Raises
    ------
    InputError : the complaints of all that raise.
    """
    made: list[Made] = []
    wrong: list[InputError] = []
    for make in makers:
        try:
            made.append(make())
        except InputError as error:
            wrong.append(error)
    if wrong:
        raise InputError.together(wrong)
    return made


def problems_of(checks: Iterable[Callable[[], object]]) -> list[InputError]:
    """Every complaint of ``checks``, each of which may raise."""
    found: list[InputError] = []
    for check in checks:
        try:
            check()
        except InputError as error:
            found += error.problems
    return found


class ShownValue(str):
    """A value as messages show it: of one that cannot leave its process, or as the file has it where that is not as
    Python has it."""

    def __repr__(self) -> str:
        return str(self)


def _portable(value: object) -> object:
    plain = (str, int, float, complex, list, tuple, dict, type(None))
    return value if isinstance(value, plain) else ShownValue(_brief(value))


def _together(parts: list[tuple[str, str, str, object, str]]) -> InputError:
    """The error of ``InputError.__reduce__``."""
    return InputError.together(InputError(p, element=e, key=k, value=v, remedy=r) for p, e, k, v, r in parts)


class _ShortRepr(reprlib.Repr):
    """``repr`` of bounded length, depth and time: a value may be a list of a million or a number of as many digits."""

    def repr_int(self, value: int, level: int) -> str:
        if value.bit_length() < 200:
            return repr(value)
        return f"a number of {int(value.bit_length() * 0.30103) + 1} digits"

    def repr_str(self, value: str, level: int) -> str:
        return repr(short(value, 60))


def _brief(value: object, limit: int = 60) -> str:
    return short(f"{value:g}" if isinstance(value, float) else _BRIEF.repr(value), limit)


_BRIEF = _ShortRepr()
_BRIEF.maxlevel = 3
_BRIEF.maxother = 60
