"""A motor, a Hooke's joint, a shaft, a disk, a shaft with play and a mill with dry friction: equations written by hand
in absolute angles, integrated by scipy from switch to switch."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import trunnion as tn


@dataclass(frozen=True)
class Numbers:
    """Inertias; joint angle; stiffness and damping of both shafts; half of the play; friction moving and at rest; the
    motor's torque over its speed; the mill's over time, in steps; the speed at t = 0."""

    inertia: tuple[float, float, float]
    angle: float
    stiffness: tuple[float, float]
    damping: tuple[float, float]
    play: float
    friction: float
    static: float
    speeds: tuple[float, ...]
    torques: tuple[float, ...]
    times: tuple[float, ...]
    blows: tuple[float, ...]
    speed: float
    switches: list[float] = field(default_factory=list, compare=False)

    @classmethod
    def random(cls, rng: np.random.Generator, *, rest: bool) -> Numbers:
        friction = float(rng.uniform(2, 15))
        return cls(
            inertia=tuple(rng.uniform(0.2, 2.0, 3)), angle=float(rng.uniform(0.05, 0.5)),
            stiffness=tuple(rng.uniform(2e3, 2e4, 2)), damping=tuple(rng.uniform(2, 20, 2)),
            play=float(rng.uniform(2e-3, 2e-2)), friction=friction, static=friction * float(rng.uniform(1, 1.5)),
            speeds=(-100.0, 5.0, 12.0, 300.0), torques=(150.0, *rng.uniform(50, 100, 2), 40.0),
            times=(0.0, 0.08, 0.11), blows=(0.0, float(rng.uniform(-400, -50)), float(rng.uniform(-150, 20))),
            speed=0.0 if rest else float(rng.uniform(1, 8)),
        )  # fmt: skip

    def line(self) -> tn.Driveline:
        a, b, c = self.inertia
        return tn.Driveline(
            [
                tn.Disk(name="motor", inertia=a),
                tn.HookeJoint(angle=self.angle),
                tn.Shaft(name="shaft", stiffness=self.stiffness[0], damping=self.damping[0]),
                tn.Disk(name="middle", inertia=b),
                tn.PiecewiseShaft(
                    name="play", breakpoints=(-self.play, self.play), damping=self.damping[1],
                    stiffnesses=(self.stiffness[1], 0.0, self.stiffness[1]),
                ),
                tn.Disk(name="mill", inertia=c),
            ]
        )  # fmt: skip

    def run(self, duration: float, start: Any = None, **options: Any) -> Any:
        motor = tn.AppliedTorque(on="motor", speed=self.speeds, torque=self.torques)
        blow = tn.AppliedTorque(on="mill", time=self.times, torque=self.blows, between="steps")
        friction = tn.FrictionTorque(on="mill", torque=self.friction, static=self.static)
        state = np.zeros(6) if start is None else start
        return tn.transient(
            self.line(), duration, torque=[motor, blow], friction=[friction], speed=self.speed, start=state, **options
        )


def _stopping(begun: float) -> Any:
    return lambda t, x, blow, sense: x[5] * sense + (1e-13 if t == begun else 0.0)


def integrated(p: Numbers, times: np.ndarray, method: str = "DOP853") -> np.ndarray:
    """Angles and speeds (time, 6) of motor, middle and mill."""
    (a, b, c), beta = p.inertia, p.angle
    cosine, square = np.cos(beta), np.sin(beta) ** 2

    def pulls(x: np.ndarray, blow: float) -> tuple[float, float, float]:
        one, two, three, v, w, u = x
        s, k = np.sin(one), np.cos(one)
        behind = one + np.arctan2(s * k * (1 - cosine), cosine * k * k + s * s)
        ratio = cosine / (1 - square * k * k)
        first = p.stiffness[0] * (two - behind) + p.damping[0] * (w - ratio * v)
        q = three - two
        second = p.stiffness[1] * (q - np.clip(q, -p.play, p.play)) + p.damping[1] * (u - w)
        return np.interp(v, p.speeds, p.torques) + ratio * first, second - first, blow - second

    def rates(t: float, x: np.ndarray, blow: float, sense: float) -> list[float]:
        one, two, three = pulls(x, blow)
        last = 0.0 if sense == 0 else (three - sense * p.friction) / c
        return [x[3], x[4], x[5] if sense else 0.0, one / a, two / b, last]

    x = np.array([0.0, 0.0, 0.0, p.speed, p.speed, p.speed])
    found = np.empty((len(times), 6))
    ends = [t for t in p.times if 0 < t < times[-1]] + [times[-1]]
    t = 0.0
    pull = pulls(x, p.blows[0])[2]
    sense = float(np.sign(x[5])) if x[5] else (float(np.sign(pull)) if abs(pull) > p.static else 0.0)
    for end in ends:
        blow = p.blows[int(np.searchsorted(p.times, t + 1e-12, side="right")) - 1]
        if sense == 0.0 and abs(pulls(x, blow)[2]) > p.static:
            sense = float(np.sign(pulls(x, blow)[2]))
        while t < end:
            switch: Any = _stopping(t) if sense else lambda _, x, blow, sense: p.static - abs(pulls(x, blow)[2])
            switch.direction, switch.terminal = -1, True
            inside = times[(times >= t) & (times <= end)]
            run = solve_ivp(
                rates, (t, end), x, method, args=(blow, sense), rtol=1e-12, atol=1e-13, events=switch,
                dense_output=True, max_step=2e-3,
            )  # fmt: skip
            seen = inside[inside <= run.t[-1]]
            found[(times >= t) & (times <= run.t[-1])] = run.sol(seen).T if len(seen) else np.empty((0, 6))
            t, x = run.t[-1], run.y[:, -1].copy()
            if run.status == 1:
                p.switches.append(t)
                pull = pulls(x, blow)[2]
                if sense:
                    x[5] = 0.0
                    sense = 0.0 if abs(pull) <= p.static else float(np.sign(pull))
                else:
                    sense = float(np.sign(pull))
    return found
