"""What is wrong with what ``assess`` says of a ``ScannedLine``, by dense scans; nothing where all of it holds.

Values at the end of an unstable range have no bound: there an order meets a pole that does not decay. What such a value
is depends on how closely the end was located, so that it is only asked to be no less than the scan's.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

import trunnion as tn
from oracles.dense_scan import Scan
from oracles.free_shooting import growth_of_own, leads_over
from oracles.growth import growth
from oracles.line_equations import Steady
from oracles.scanned_lines import ScannedLine

Array = NDArray[np.float64]
Ranges = tuple[tuple[float, float], ...]
ROUNDING, ALIKE, SCANNED = 1e-9, 1e-6, 2e-3
"""Shares: of a value, what both compute at one speed, what lies between two speeds of the scan."""
OWN = 1e-4
"""The same of the scan's own periodic motion of a free line, beside an end: a torque of free 105 is 4415.880, 4417.553,
4417.427, 4417.406 and 4417.404 N m with 20, 64, 96, 128 and 224 samples a cycle, and 4417.354 by a balance whose digits
no closer tolerance changes."""
EDGE, BESIDE_EDGE = 1e-5, 1e-3
"""How closely ends of unstable ranges and gaps are checked, and within which values there are without bound; of the
speed."""
PLAIN, MOST_MEETINGS = 30, 40
"""Speeds at which growth is computed where the line is said to be stable."""
NAME = "parametric stability"


@dataclass
class Judged:
    """The faults found, in sentences; processor time [s] of the package and of the scan; the smallest of value + error
    over what the scan found, less 1; how many values were compared, and those whose top no speed of the scan came near
    (they are checked at their own speed like every other); ranges said to be unstable, and those that are not judged
    since the motion of a free line breaks off there."""

    faults: list[str] = field(default_factory=list)
    own_time: float = 0.0
    scan_time: float = 0.0
    least: float = np.inf
    largest: float = -np.inf
    compared: int = 0
    missed: list[str] = field(default_factory=list)
    unstable: Ranges = ()
    gaps: Ranges = ()


def variants(line: ScannedLine, left_out: Ranges) -> dict[str, Scan]:
    """The line as stated, under its load cases and along its schedule."""
    found = {"": Scan(line.unscheduled(), line.low, line.high, left_out)}
    if line.schedule:
        found["along"] = Scan(line, *line.schedule, left_out)
    for k, case in enumerate(line.cases):
        found[f"case {k}"] = Scan(line.loaded(case), line.low, line.high, left_out)
    return found


def judged(line: ScannedLine) -> Judged:
    """``assess`` of a line, or ``envelope`` of one with a schedule, beside its scans."""
    found, begin = Judged(), time.process_time()
    said = tn.envelope(line.driveline, points=2) if line.schedule else tn.assess(line.driveline)
    found.own_time = time.process_time() - begin
    checks = {check.name: check for check in said.checks}
    found.unstable = checks[NAME].barred
    if Steady(line).moves and checks[NAME].covered:
        found.gaps = _between(checks[NAME].covered, line)
    beside = tuple((a * (1 - EDGE), b * (1 + EDGE)) for a, b in found.gaps)
    left_out = tuple(sorted((*found.unstable, *beside)))
    scans = variants(line, left_out)
    largest = {name: scan.largest() for name, scan in scans.items()}
    there: dict[float, list[dict[str, float]]] = {}
    for name in largest[""]:
        value, speed = max(one[name] for one in largest.values())
        check = checks.get(name)
        if check is None or not check.judged:
            why = check.because if check else "no such check"
            found.faults.append(f"{name}: {why}; {value:.9g} at {speed:.9g} rad/s")
            continue
        over = check.limit if name.startswith("gear hammer") else 1.0
        own = check.value / over
        found.compared += 1
        found.least = min(found.least, (own + check.error / over) / value - 1)
        says = f"{name}: {own:.12g} ± {check.error / over:.2g} at {check.speed:.12g} rad/s"
        if not np.isfinite(value):
            found.missed.append(f"{says}: no motion found by the scan")
            continue
        beside = any(abs(speed / end - 1) < BESIDE_EDGE for pair in left_out for end in pair)
        if not own + check.error / over >= value * (1 - (OWN if beside and scans[""].steady.moves else ROUNDING)):
            found.faults.append(f"{says} is low: {value:.12g} at {speed:.12g} rad/s")
        if any(a * (1 - BESIDE_EDGE) < check.speed < b * (1 + BESIDE_EDGE) for a, b in left_out):
            continue
        found.largest = max(found.largest, own / value - 1)
        if check.speed not in there:
            there[check.speed] = [scan.at(check.speed) for scan in scans.values()]
        known = [one[name] for one in there[check.speed] if np.isfinite(one[name])]
        if known and min(abs(own / one - 1) for one in known) > ALIKE + check.error / check.value:
            found.faults.append(f"{says} is none there: {', '.join(f'{one:.12g}' for one in known)}")
        if own > value * (1 + SCANNED):
            noted = found.missed if known else found.faults
            noted.append(f"{says} is high: {value:.12g} at {speed:.12g} rad/s")
    if checks[NAME].judged or found.gaps:
        found.faults += _of_ranges(scans, found, line)
    found.faults += [f"the motion goes on between {a:.9g} and {b:.9g} rad/s" for a, b in found.gaps
                     if leads_over(scans[""].steady, a * (1 - EDGE), b * (1 + EDGE))]  # fmt: skip
    found.scan_time = time.process_time() - begin - found.own_time
    return found


def _between(covered: Ranges, line: ScannedLine) -> Ranges:
    """What lies between the ranges that a check covers."""
    ends = [line.low, *(end for pair in sorted(covered) for end in pair), line.high]
    return tuple((a, b) for a, b in zip(ends[::2], ends[1::2], strict=True) if b > a)


def _of_ranges(scans: dict[str, Scan], found: Judged, line: ScannedLine) -> Iterator[str]:
    """Ends of unstable ranges, and growth where there is none."""
    first, unstable = scans[""].steady, found.unstable
    if not first.joint_rates and not any(one.waves for _, one in first.links):
        return
    lost = [end for pair in found.gaps for end in pair]
    wide = [(a, b) for a, b in unstable if b / a - 1 > 4 * EDGE]
    inside = [(a + b) / 2 for a, b in wide]
    # Beside a gap, where no motion is known, growth is said from the gap on: too much, never too little.
    inside += [a * (1 + EDGE) for a, _ in wide if not _near(a, lost)]
    inside += [b * (1 - EDGE) for _, b in wide if not _near(b, lost)]
    if inside:
        grows = _fastest(scans, np.array(inside), of_speed=True)
        yield from (f"stable at {s:.9g} rad/s" for s, g in zip(inside, grows, strict=True) if g <= 0)
    ends = [a * (1 - EDGE) for a, _ in unstable if a > line.low * (1 + EDGE) and a not in lost]
    ends += [b * (1 + EDGE) for _, b in unstable if b < line.high * (1 - EDGE) and b not in lost]
    plain = scans[""].kept(np.concatenate([np.linspace(line.low, line.high, PLAIN), _pairs(scans[""])]))
    outside = np.array([s for s in (*ends, *plain) if not any(a <= s <= b for a, b in (*unstable, *found.gaps))])
    grows = _fastest(scans, outside, of_speed=False)
    yield from (f"grows at {s:.12g} rad/s, by {g:.3g} 1/s" for s, g in zip(outside, grows, strict=True) if g > 1e-7)


def _near(speed: float, ends: list[float]) -> bool:
    return any(abs(speed / end - 1) < BESIDE_EDGE for end in ends)


def _fastest(scans: dict[str, Scan], speed: Array, *, of_speed: bool) -> Array:
    """Growth [1/s] of whichever of the lines grows fastest, each where it is scanned; −∞ where it is not known."""
    found = np.full(len(speed), -np.inf)
    for scan in scans.values():
        here = np.flatnonzero((speed >= scan.low * (1 - 2 * EDGE)) & (speed <= scan.high * (1 + 2 * EDGE)))
        if len(here):
            steady, at = scan.steady, speed[here]
            own = growth_of_own(steady, at) if steady.moves else growth(steady, at, of_speed=of_speed)
            found[here] = np.maximum(found[here], np.where(np.isnan(own), -np.inf, own))
    return found


def _pairs(scan: Scan) -> Array:
    """Speeds at which two poles may open a resonance, the least damped of them: Im s_i + Im s_j = cΩ."""
    steady = scan.steady
    rates = {float(rate) for rate in steady.joint_rates}
    rates |= {float(steady.teeth[e] * o) for e, (_, one) in enumerate(steady.links) for _, o, _ in one.waves}
    poles = scan.poles(np.array([(scan.low + scan.high) / 2]))[0][0]
    found = [
        ((poles[i] + poles[j]).imag / (rate * k), -(poles[i] + poles[j]).real)
        for rate in rates
        for k in (1, 2)
        for i in range(len(poles))
        for j in range(i, len(poles))
    ]
    within = sorted((damping, speed) for speed, damping in found if scan.low < speed < scan.high)
    return np.array([speed for _, speed in within[:MOST_MEETINGS]])
