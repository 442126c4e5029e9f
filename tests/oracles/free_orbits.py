"""The periodic motion of a free–free line with joint angles, by collocation of Lagrange's equations at even angles.

a_i = R_i Ωt + level_i + y_i(Ωt), y of the joints' period, its mean zero for the first mass; one more unknown is the
torque that the first mass drives with beyond the balance of the loads.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from oracles.line_equations import Base, Steady

Array = NDArray[np.float64]
STEPS, CLOSED = 30, 1e-12
"""Newton's steps, and the share of the elastic torque at which a motion is found."""
ANCHORS = 60
"""Even speeds at which motions are looked for besides, where some are not found."""
WALK, LEAP = 60, 0.1
"""Steps at most from a motion to another, and by how much [rad] one may change it."""


def derivatives(times: int) -> tuple[Array, Array]:
    """First and second derivative of periodic samples over 2π, (times, times)."""
    order = np.fft.fftfreq(times, 1 / times)
    first = np.where(2 * np.abs(order) == times, 0.0, 1j * order)
    wave = np.fft.fft(np.eye(times), axis=0)
    return tuple(np.fft.ifft(part[:, None] * wave, axis=0).real for part in (first, -(order**2)))  # type: ignore[return-value]


def moved(line: Steady, speed: Array, turned: Array, y: Array) -> Base:
    """The base of deviations y (speed, time, mass) from even rotation."""
    from oracles.line_equations import Base

    one, two = derivatives(len(turned))
    rate = float(line.step) * speed[:, None, None]
    ratio = np.array([float(r) for r in line.mean_ratio])
    a = line.level + turned[:, None] * ratio + y
    v = speed[:, None, None] * ratio + rate * np.einsum("ts,csn->ctn", one, y)
    w = rate**2 * np.einsum("ts,csn->ctn", two, y)
    r, r1, torque = (np.zeros((*y.shape[:2], len(line.links))) for _ in range(3))
    (k, c, _), bends = line.springs(), line.bends(speed)
    for e, (far, link) in enumerate(line.links):
        n, r[..., e], r1[..., e] = line.passed(link, e, a[..., link.near], bends)
        torque[..., e] = k[e] * (a[..., far] - n - link.fork) + c[e] * (v[..., far] - r[..., e] * v[..., link.near])
    return Base(a, v, w, r, r1, torque, line.level)


def twists(line: Steady, base: Base) -> Array:
    """Elastic twist (speed, time, spring)."""
    k, c, _ = line.springs()
    found = np.zeros_like(base.torque)
    for e, (far, link) in enumerate(line.links):
        rate = base.rate[..., far] - base.ratio[..., e] * base.rate[..., link.near]
        found[..., e] = (base.torque[..., e] - c[e] * rate) / k[e]
    return found


def orbit(line: Steady, speed: Array, turned: Array) -> Base:
    """The motion at every speed, from rigid shafts, else in steps from that of the nearest speed known; NaN where
    neither leads to one."""
    lost = kept(line, speed, turned)
    if len(lost) and not line.anchored:
        kept(line, np.linspace(line.line.low, line.line.high, ANCHORS), turned)
        line.anchored = True
    for one in lost.tolist():
        _walk(line, one, turned)
    y = np.stack([line.orbits.get(one, np.full((len(turned), line.n), np.nan)) for one in speed.tolist()])
    return moved(line, speed, turned, y)


def kept(line: Steady, speed: Array, turned: Array) -> Array:
    """Look for motions from rigid shafts, and keep those that are found; the speeds of the others."""
    speed = np.array([one for one in np.unique(speed).tolist() if one not in line.orbits])
    if not len(speed):
        return speed
    rigid = line.rigid(speed, turned)
    ratio = np.array([float(r) for r in line.mean_ratio])
    y = rigid.angle - line.level - turned[:, None] * ratio
    y = _closed(line, speed, turned, np.ascontiguousarray(y - y[..., :1].mean(axis=1, keepdims=True)))
    lost = np.isnan(y).any(axis=(1, 2))
    line.orbits |= {one: own for one, own, off in zip(speed.tolist(), y, lost, strict=True) if not off}
    return speed[lost]


def _walk(line: Steady, speed: float, turned: Array) -> None:
    """From the nearest motion known to that at ``speed``, in steps that are halved where one leads nowhere."""
    if not line.orbits:
        return
    at = min(line.orbits, key=lambda one: abs(one - speed))
    y, step = line.orbits[at], speed - at
    for _ in range(WALK):
        to = speed if abs(speed - at) <= abs(step) else at + step
        found = _closed(line, np.array([to]), turned, y[None])[0]
        if np.isnan(found).any() or np.abs(found - y).max() > LEAP:
            step = (to - at) / 2
            continue
        at, y, step = to, found, 2 * (to - at)
        if at == speed:
            line.orbits[at] = y
            return


def _closed(line: Steady, speed: Array, turned: Array, y: Array) -> Array:
    """Newton's steps from ``y`` (speed, time, mass)."""
    times, n = len(turned), line.n
    y = y.copy()
    one, two = derivatives(times)
    extra = np.zeros(len(speed))
    inertia = np.array([m.inertia for m in line.line.masses])
    constant = line.constant_loads(speed)[:, None]
    scale = line.springs()[0].max()
    open_ones = np.arange(len(speed))
    for _ in range(STEPS):
        now = speed[open_ones]
        base = moved(line, now, turned, y[open_ones])
        damping, stiffness, left = line.equations(base)
        left = left - constant[open_ones]
        left[..., 0] += extra[open_ones, None]
        rate = (float(line.step) * now)[:, None, None, None, None]
        size = times * n
        jacobian = rate * damping[:, :, :, None, :] * one[:, None, :, None]
        jacobian += rate**2 * (np.diag(inertia)[:, None, :] * two[:, None, :, None])
        jacobian[:, np.arange(times), :, np.arange(times), :] += np.moveaxis(stiffness, 1, 0)
        more = np.zeros((len(now), size + 1, size + 1))
        more[:, :size, :size] = jacobian.reshape(len(now), size, size)
        more[:, :size:n, size] = -scale
        more[:, size, :size:n] = scale / times
        right = np.concatenate([left.reshape(len(now), size), np.zeros((len(now), 1))], axis=1)
        step = np.linalg.solve(more, right[..., None])[..., 0]
        y[open_ones] += step[:, :size].reshape(-1, times, n)
        extra[open_ones] += step[:, size] * scale
        large = np.abs(step[:, :size]).max(axis=1) > CLOSED
        open_ones = open_ones[large]
        if not len(open_ones):
            break
    y[open_ones] = np.nan
    return y
