"""Work on a thread beside other work: its result, its errors, its end."""

from __future__ import annotations

import time

import pytest

import trunnion as tn
from trunnion.numerics.threads import beside
from trunnion.waiting import OutOfTime, keep_time, time_is_up


def until_stopped() -> str:
    """Work in pieces, as searches are."""
    began = time.monotonic()
    while not time_is_up():
        assert time.monotonic() - began < 60
        time.sleep(1e-3)
    return "stopped"


def test_its_result_or_its_error_is_had_where_it_is_asked_for() -> None:
    with beside(lambda: 6 * 7) as found:
        assert found() == 42

    def refuses() -> None:
        raise tn.InputError("is none", key="of it")

    with beside(refuses) as found, pytest.raises(tn.InputError, match="of it: is none"):
        found()


def test_an_error_meanwhile_stops_it() -> None:
    with pytest.raises(KeyboardInterrupt), beside(until_stopped) as found:
        raise KeyboardInterrupt
    assert found() == "stopped"


def test_it_keeps_the_time_limit_around_it() -> None:
    def late() -> None:
        until_stopped()
        keep_time()

    with tn.time_limit(0.05), beside(late) as found, pytest.raises(OutOfTime, match="time limit of 0.05 s"):
        found()
