"""``animate``: a line in motion, to watch it turn, swing, shake or get through a resonance."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from trunnion.animation import movements
from trunnion.animation.animation import Animation
from trunnion.animation.movement import Movement
from trunnion.animation.scene import ShownMotion
from trunnion.animation.scenery import scenery
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.refusals import nearest
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError

WHAT: Mapping[str, Callable[..., tuple[Assembly, Any]]] = {
    "turning": movements.turning,
    "mode": movements.mode,
    "response": movements.response,
    "motion": movements.motion,
    "disturbance": movements.disturbance,
    "run-up": movements.run_up,
    "transient": movements.transient,
    "passing": movements.passing,
}
ASKED: Mapping[str, tuple[str, ...]] = {
    "turning": ("speed",),
    "mode": ("mode",),
    "response": ("speed",),
    "motion": ("speed",),
    "disturbance": ("speed", "beside"),
    "run-up": ("speeds", "acceleration"),
    "transient": ("scenario",),
    "passing": ("speeds", "scenario"),
}
"""Which arguments each takes."""


def animate(
    line: Driveline | Assembly,
    what: str = "turning",
    *,
    speed: float | str | None = None,
    mode: int | None = None,
    beside: float | str | None = None,
    speeds: tuple[float, float] | None = None,
    acceleration: float | None = None,
    scenario: str | None = None,
) -> Animation:
    """A driveline in motion, in space.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    what : what is shown. "turning": shafts are rigid, joints at work. "mode": a mode of the straight line.
        "response": the linear response to all that excites it. "motion": its true periodic motion, gaps and all.
        "disturbance": the one that grows fastest, beside one that decays. "run-up": the way through its resonances.
        "transient": a scenario of the file. "passing": whether the line comes from one speed to another under the
        torques of a scenario or of its motor.
    speed : of the input [rad/s], a number or a text with its unit; default the operating speed of the file. It belongs
        to turning, response, motion and disturbance.
    mode : its number, counted from 1 among those that vibrate; default 1.
    beside : speed of the other disturbance [rad/s]; default the nearest one looked at where it does the opposite.
    speeds : first and last of a run-up or a passing [rad/s]; default the range of the file.
    acceleration : of a run-up [rad/s²]; default what takes ten seconds.
    scenario : of a transient, by name, default the first; of a passing, default the line's motor.

    Returns
    -------
    Animation: ``save`` writes a page that opens without a network, a GIF or JSON; a notebook shows it.

    Raises
    ------
    InputError : an unknown ``what``, an argument that it does not take, or what the analysis behind it refuses.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.3), shaft, tn.Disk(inertia=0.8)])
    >>> print(tn.animate(line, "turning", speed="600 rpm"))
    driveline in motion; .save(path) writes a page, a GIF or JSON
      turning: The line turns at 62.8319 rad/s, shafts rigid: its joints make the shafts behind them uneven.
        97 frames over 0.1 s; twist drawn 1 times as it is
    """
    if what not in WHAT:
        raise InputError("is not a motion of a line", key="what", value=what, remedy=nearest(str(what), WHAT))
    given = {
        "speed": speed, "mode": mode, "beside": beside, "speeds": speeds, "acceleration": acceleration,
        "scenario": scenario,
    }  # fmt: skip
    asked = {key: value for key, value in given.items() if value is not None}
    for key, value in asked.items():
        if key not in ASKED[what]:
            remedy = f"leave it out; {what} takes {' and '.join(ASKED[what])}"
            raise InputError(f"does not belong to {what}", key=key, value=value, remedy=remedy)
    if "mode" in asked:
        asked["number"] = asked.pop("mode")
    assembly, found = WHAT[what](line, **asked)
    shown: tuple[Movement, ...] = found if isinstance(found, tuple) else (found,)
    drawn = scenery(assembly.line, assembly.topology)
    title = assembly.line.name or "driveline"
    return Animation(title, (ShownMotion(what if what != "mode" else shown[0].title, drawn, shown),))
