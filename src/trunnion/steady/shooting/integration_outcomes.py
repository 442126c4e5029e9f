"""What became of an integration, in a sentence: what happened, where, and what to change."""

from __future__ import annotations

import numpy as np

from trunnion.numerics.integration.integration import IntegrationEnd, Trajectory
from trunnion.results.outcome import Outcome
from trunnion.systems.system import System
from trunnion.systems.user_functions import WRONG_SHAPE, parameter_tuple, store
from trunnion.waiting import time_is_up

GROWN = 1e6
"""Growth of the state over a run beyond which a vanishing step is called a blow-up."""

OUT_OF_TIME = "out of time"
"""Kind of the outcome of a run that a time limit ended."""

TINY = 1e-5
"""Size of all states over their scale below which the scale is what to change."""


def outcome_of(system: System, run: Trajectory, tolerance: float, guards: tuple[str, ...]) -> Outcome:
    """The outcome of ``run``; ``guards`` name the system's guards and then the caller's events."""
    _pass_on_interrupt(system)
    if run.end is IntegrationEnd.REACHED:
        return Outcome(True, "reached", f"reached t = {run.time:.6g} s in {run.steps} steps")
    at = f"at t = {run.time:.6g} s"
    largest = int(np.argmax(np.abs(np.nan_to_num(run.final[0], nan=np.inf)) / np.asarray(system.scale)))
    value = f"{system.states[largest]} = {run.final[0, largest]:.3g}"
    if run.end is IntegrationEnd.STOPPED:
        return Outcome(True, "stopped", f"stopped {at} by the event {guards[int(run.event_which[-1])]}")
    if run.end is IntegrationEnd.OUT_OF_TIME:
        why = time_is_up() or "the search was stopped"
        return Outcome(False, OUT_OF_TIME, f"{why.replace('the search', 'the run')} {at}; what was computed is kept")
    if run.end is IntegrationEnd.STEP_LIMIT:
        return Outcome(
            False,
            "step limit",
            f"stopped {at} after {run.steps} steps; raise most_steps, ask for a shorter time, or loosen "
            f"tolerance = {tolerance:g}{_scaled(system, run)}",
        )
    if run.end is IntegrationEnd.CHATTER:
        name = guards[int(run.event_which[-1])]
        return Outcome(
            False,
            "chatter",
            f"the event {name} chatters {at}: it fires again and again within rounding, so the motion sticks or "
            "slides there; give the system a regime for sticking, or smooth the law",
        )
    grown = np.abs(run.final[0]) > GROWN * np.maximum(np.abs(run.state[0]), np.asarray(system.scale))
    if run.end is IntegrationEnd.BEYOND or (
        run.end in (IntegrationEnd.TOO_SMALL, IntegrationEnd.NOT_FINITE) and np.any(grown)
    ):
        return Outcome(
            False,
            "blow-up",
            f"the motion blows up {at}: {value}; check signs and damping, or end the run before that",
        )
    if run.end is IntegrationEnd.REFUSED:
        return Outcome(False, "refused", f"near {at[3:]} the right-hand side of {system.name} {_refusal(system, run)}")
    if run.end is IntegrationEnd.NOT_FINITE:
        return Outcome(
            False,
            "not finite",
            f"the right-hand side of {system.name} is not finite near {at[3:]} ({value}); check it for roots and "
            "quotients there, or start elsewhere",
        )
    return Outcome(
        False,
        "step too small",
        f"no step {at} is small enough for tolerance = {tolerance:g} ({value}); loosen the tolerance, or describe a "
        f"jump in the right-hand side by regimes{_scaled(system, run)}",
    )


def _scaled(system: System, run: Trajectory) -> str:
    """Advice where the states move in other sizes than their scale, in which errors are measured."""
    moved = np.abs(run.state[np.isfinite(run.state).all(axis=1)]).max(axis=0, initial=0.0)
    share = moved / np.asarray(system.scale)
    if not share.any() or TINY < share.max() < 1 / TINY:
        return ""
    given = ", ".join(f"{size:.1g}" for size in np.maximum(moved, moved.max() * TINY))
    return f"; its states are about {moved.max():.1g} where their scale says 1 is usual: give scale = ({given})"


def _pass_on_interrupt(system: System) -> None:
    """A Ctrl-C that met the interpreter inside the right-hand side."""
    for error in system.rate.raised:
        if not isinstance(error, Exception):
            raise error


def _refusal(system: System, run: Trajectory) -> str:
    """Ask the Python function what it minds; it may do so only a little further on."""
    if system.rate.raised:
        return f"raised {type(system.rate.raised[0]).__name__}: {system.rate.raised[0]}; correct it"
    if system.function is not None:
        function = getattr(system.function, "py_func", system.function)
        p = parameter_tuple(tuple(system.parameters))(*system.parameters.values())
        regime = (run.final_regime,) if system.regimes is not None else ()
        rate = system.rate_at(run.time, run.final[0], run.final_regime)
        rate = rate if np.all(np.isfinite(rate)) else np.zeros(system.size)
        for ahead in (0.0, *np.logspace(-15, -2, 14)):
            try:
                value = function(run.time + ahead, run.final[0] + ahead * rate, p, *regime)
            except Exception as error:
                return f"raised {type(error).__name__}: {error}; correct it, or start elsewhere"
            if np.shape(value) != (system.size,):
                break
        if store(np.zeros(system.size), value) == WRONG_SHAPE:
            return (
                f"returned an array of shape {np.shape(value)} where ({system.size},) is needed; return one number "
                "per state"
            )
    return "(or a guard) could not be evaluated; check it"
