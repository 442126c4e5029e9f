"""How long a computation may take, and the word to stop it: one limit for everything that is computed inside it.

``with time_limit(30.0):`` holds for all that is called within, on other threads too (``numerics.threads``). Work that
comes in pieces calls ``keep_time()`` before each of them, which raises ``OutOfTime`` once the time is up or ``stop``
was called. Whoever has something to show for the time spent catches it, and says in the result what was not reached;
elsewhere it passes through, so that nothing half-searched is taken for an answer.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from math import inf, isfinite
from typing import ParamSpec, TypeVar

from trunnion.errors import InputError, TrunnionError

P = ParamSpec("P")
R = TypeVar("R")


class OutOfTime(TrunnionError):
    """A computation was ended by its time limit, or on request. ``why``: as a clause, "the time limit of 30 s ended the
    search"."""

    def __init__(self, why: str) -> None:
        self.why = why
        super().__init__(f"{why} before anything was known; allow more time")


class TimeLimit:
    """How long what is computed inside may take; ``stop`` ends it at once.

    seconds: allowed, None for any; noticed: whether a computation has ended by it; clock: what tells the time [s];
    stated: seconds that were asked for, of which these are what is left.
    """

    def __init__(
        self,
        seconds: float | None = None,
        clock: Callable[[], float] = time.monotonic,
        stated: float | None = None,
    ) -> None:
        self.seconds, self.clock = seconds, clock
        self.stated = seconds if stated is None else stated
        self.ends = inf if seconds is None else clock() + seconds
        self.stopped = self.noticed = False
        self.outer = _LIMIT.get()

    def stop(self) -> None:
        """Ask for an end: from another thread, a signal or ``progress``. What is computed inside gives what it has."""
        self.stopped = True

    @property
    def over(self) -> bool:
        """Whether the time is up or an end was asked for, of this limit or one around it."""
        return self.stopped or self.clock() >= self.ends or (self.outer is not None and self.outer.over)

    @property
    def left(self) -> float:
        """Seconds left, infinite without a limit."""
        outer = inf if self.outer is None else self.outer.left
        return 0.0 if self.stopped else max(min(self.ends - self.clock(), outer), 0.0)

    @property
    def why(self) -> str:
        """What ended the search, as a clause."""
        if not self.stopped and self.clock() < self.ends and self.outer is not None:
            return self.outer.why
        if self.stopped or self.stated is None:
            return "the search was stopped"
        return f"the time limit of {self.stated:.3g} s ended the search"

    def notice(self) -> None:
        """A computation ends by it."""
        self.noticed = True
        if self.outer is not None:
            self.outer.notice()


_LIMIT: ContextVar[TimeLimit | None] = ContextVar("time_limit", default=None)


@contextmanager
def time_limit(
    seconds: float | None = None, *, of_processor: bool = False, stated: float | None = None
) -> Iterator[TimeLimit]:
    """A limit for everything that is computed inside; of limits within one another the one that ends first counts.

    Parameters
    ----------
    seconds : allowed; None for as long as it takes, or until ``stop`` of what it gives is called.
    of_processor : whether they are counted while this process computes, all its threads together, so that a busy
        machine leaves out no more than an idle one.
    stated : seconds that what was ended names, where these are the rest of a longer time; by default ``seconds``.

    Raises
    ------
    InputError : seconds that are not a positive number. OutOfTime : the time was up before anything was known.

    Examples
    --------
    >>> import trunnion as tn
    >>> with tn.time_limit(60.0) as limit:
    ...     found = tn.assess(tn.catalogue("two-shaft-cardan"), (1.0, 2.0))
    >>> limit.noticed
    False
    """
    if seconds is not None and not (_is_number(seconds) and 0 < seconds < inf):
        raise InputError("must be a positive time", key="within", value=seconds, remedy="seconds, 30.0 say")
    limit = TimeLimit(seconds, time.process_time if of_processor else time.monotonic, stated)
    token = _LIMIT.set(limit)
    try:
        yield limit
    finally:
        _LIMIT.reset(token)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


@contextmanager
def to_the_end() -> Iterator[None]:
    """No limit inside: for the little that makes a result of what was found when time was up."""
    token = _LIMIT.set(None)
    try:
        yield
    finally:
        _LIMIT.reset(token)


def keep_time() -> None:
    """Between two pieces of work.

    Raises
    ------
    OutOfTime : the time is up, or an end was asked for.
    """
    limit = _LIMIT.get()
    if limit is not None and limit.over:
        limit.notice()
        raise OutOfTime(limit.why)


def time_is_up() -> str:
    """What ended the search, as a clause; "" while there is time. For loops that keep what they have."""
    limit = _LIMIT.get()
    if limit is None or not limit.over:
        return ""
    limit.notice()
    return limit.why


@contextmanager
def time_kept(reserve: float, share: float) -> Iterator[None]:
    """The limit around it ends ``reserve`` seconds earlier inside, for what is to be done with the outcome; at least a
    ``share`` of the time left stays."""
    outer = _LIMIT.get()
    limit = TimeLimit() if outer is None else TimeLimit(outer.seconds, outer.clock, outer.stated)
    if outer is not None and outer.left < inf:
        limit.ends = limit.clock() + max(outer.left - reserve, share * outer.left)
    token = _LIMIT.set(limit)
    try:
        yield
    finally:
        _LIMIT.reset(token)


def uncounted(seconds: float) -> None:
    """Processor time that limits of it do not count: of what happens once on a machine, as compiling does."""
    limit = _LIMIT.get()
    while limit is not None:
        if limit.clock is time.process_time:
            limit.ends += seconds
        limit = limit.outer


def limited() -> bool:
    """Whether there is a limit, so that work is better done in pieces that are of use by themselves."""
    return _LIMIT.get() is not None


def seconds_left() -> float:
    """Seconds left, infinite without a limit."""
    limit = _LIMIT.get()
    return inf if limit is None else limit.left


def keeps_time(function: Callable[P, R]) -> Callable[P, R]:
    """A function that ends within its keyword ``within`` [s], None for as long as it takes."""

    @wraps(function)
    def timed(*args: P.args, **kwargs: P.kwargs) -> R:
        within = kwargs.get("within")
        if within is None:
            return function(*args, **kwargs)
        with time_limit(within):  # type: ignore[arg-type]
            return function(*args, **kwargs)

    return timed
