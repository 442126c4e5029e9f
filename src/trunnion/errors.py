"""The two ways a request can fail, and the remark that does not stop it.

Every message is one line that names the element, the key, the value and the remedy; the command line
prints it as it stands and turns the class into an exit code (2 for bad input, 1 for a failed computation).
"""

from __future__ import annotations


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
        super().__init__(self.sentence())

    def sentence(self) -> str:
        """The whole message on one line."""
        place = ".".join(part for part in (self.element, self.key) if part)
        shown = "" if self.value is None else f" = {_brief(self.value)}"
        head = f"{place}{shown}: " if place or shown else ""
        tail = f"; {self.remedy}" if self.remedy else ""
        return " ".join(f"{head}{self.problem}{tail}".split())


class ComputationError(TrunnionError, RuntimeError):
    """The input was fine and the computation still failed; says at which point and which knob to turn."""

    exit_code = 1


class InputRemark(UserWarning):
    """The input is accepted, but a colleague would ask whether it is meant."""


def _brief(value: object, limit: int = 60) -> str:
    text = f"{value:g}" if isinstance(value, float) else repr(value)
    return text if len(text) <= limit else text[: limit - 1] + "…"
