"""What a frequency response is: one by one method, or several side by side."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from trunnion.analyses.orbits.branch import PeriodicBranch
from trunnion.analyses.perturbation.slow_flow import largest_stable
from trunnion.arrays import Array, Flags
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.numerics.curves import at_place, meetings
from trunnion.results.declared import Described, Held, ending, fields_over, over, remark
from trunnion.results.drawing import Axes, drawing
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import speed_factor
from trunnion.results.verdict import Verdict


@dataclass(frozen=True, repr=False)
class FrequencyResponse(Described):
    """Half peak-to-peak over frequency by one method.

    frequency (points,) [rad/s] in order along the curve; half_peak_to_peak (points,) of x or of ``curve``, a state or a
    shaft's torque; stable (points,); marks: (kind, frequency, half peak-to-peak) of folds, flips, grazing, or of jumps
    of a sweep; seconds it took; detail: the method's own result; unit: what frequencies read in, of a driveline the
    unit of its description.
    """

    method: str
    frequency: Array
    half_peak_to_peak: Array
    stable: Flags
    marks: tuple[tuple[str, float, float], ...]
    outcome: Outcome
    seconds: float
    detail: Any
    curve: str = "x"
    unit: str = "rad/s"

    @property
    def peak(self) -> tuple[float, float]:
        """Frequency and half peak-to-peak of the largest stable motion."""
        return largest_stable(self.frequency, self.half_peak_to_peak, self.stable)

    def folds(self) -> tuple[float, ...]:
        """Frequencies of the folds, falling; of a sweep, where it jumps."""
        return tuple(sorted((f for kind, f, _ in self.marks if kind in ("fold", "jump")), reverse=True))

    def at(self, frequency: float) -> list[tuple[float, bool]]:
        """Half peak-to-peak and stability of every motion at a frequency, by falling size.

        Computed there where the method follows a branch; approximations and sweeps are interpolated linearly.
        """
        branch = getattr(self.detail, "branch", self.detail)
        if isinstance(branch, PeriodicBranch):
            i = place_of(branch.curves, self.curve)
            seen = branch.swings_at(frequency)
            return sorted(((float(swing[i]) / 2, verdict is Verdict.STABLE) for swing, verdict in seen), reverse=True)
        places = meetings(self.frequency, frequency)
        size = self.half_peak_to_peak
        return sorted(((float(at_place(size, p)), bool(self.stable[int(p)])) for p in places), reverse=True)

    def declared(self) -> Iterator[Held]:
        """Half peak-to-peak and stability over the points of the curve, and its marks."""
        yield from fields_over("point", self, frequency="rad/s", half_peak_to_peak="", stable="")
        yield over("mark", "mark_kind", np.array([m[0] for m in self.marks], dtype=str))
        yield over("mark", "mark_frequency", np.array([m[1] for m in self.marks], dtype=float), "rad/s")
        yield remark("method", self.method)
        yield remark("curve", self.curve)
        yield from ending(self.outcome)

    def plot(
        self,
        axes: Axes | None = None,
        *,
        length: str = "",
        unit: str | None = None,
        marks: bool = True,
        jumps: bool = True,
        top: float | None = None,
    ) -> Axes:
        """The curve, full where stable; see ``trunnion.plots.frequency_response``."""
        return drawing(self, "plot")(self, axes, length=length, unit=unit, marks=marks, jumps=jumps, top=top)

    def describe(self, unit: str | None = None) -> str:
        """In words, its frequencies in ``rad/s``, ``rpm`` or ``Hz``, by default in its own ``unit``."""
        unit = unit or self.unit
        if not len(self.frequency):
            return f"no frequency response by {self.method}: {self.outcome}"
        at, size = self.peak
        factor = speed_factor(unit)
        rows = [f"  {kind} at {f * factor:.7g} {unit}, {a:.6g}" for kind, f, a in self.marks]
        of = "" if self.curve == "x" else f" of {self.curve}"
        largest = f"largest stable half peak-to-peak{of} {size:.6g} at {at * factor:.6g} {unit}"
        head = (
            f"frequency response by {self.method}: {len(self.frequency)} points, {int(self.stable.sum())} stable, "
            f"{self.seconds:.2g} s\n  {largest if np.isfinite(size) else 'no motion is stable beyond doubt'}"
        )
        return "\n".join([head, *rows, f"  {self.outcome}"])


@dataclass(frozen=True, repr=False)
class ResponseComparison(Described):
    """Several methods side by side; the first is what the others are measured against."""

    responses: Mapping[str, FrequencyResponse]

    def __getitem__(self, method: str) -> FrequencyResponse:
        """One of them."""
        return self.responses[method]

    @property
    def unit(self) -> str:
        """What frequencies read in: that of the first."""
        return next((r.unit for r in self.responses.values()), "rad/s")

    def table(self, frequencies: Sequence[float] = (), unit: str | None = None) -> list[tuple[str, ...]]:
        """Rows of words: method, peak with its frequency, folds, the stable motions at some frequencies, seconds.

        ``frequencies`` in rad/s; those in the table in ``unit``, by default the description's.
        """
        unit = unit or self.unit
        factor = speed_factor(unit)
        stable = (f"stable at {f * factor:g}" for f in frequencies)
        rows: list[tuple[str, ...]] = [("method", "peak", f"at [{unit}]", "folds", *stable, "seconds")]
        for name, r in self.responses.items():
            at, size = r.peak
            folds = ", ".join(f"{f * factor:#.6g}" for f in r.folds()) or "none"
            motions = [", ".join(f"{a:#.5g}" for a, ok in r.at(f) if ok) or "none" for f in frequencies]
            rows.append((name, f"{size:#.5g}", f"{at * factor:#.6g}", folds, *motions, f"{r.seconds:.2g}"))
        return rows

    def declared(self) -> Iterator[Held]:
        """The points of all curves one after the other, each with its method."""
        found = list(self.responses.values())
        yield over("point", "method", np.array([r.method for r in found for _ in r.frequency], dtype=str))
        yield over("point", "frequency", np.concatenate([r.frequency for r in found]), "rad/s")
        yield over("point", "half_peak_to_peak", np.concatenate([r.half_peak_to_peak for r in found]))
        yield over("point", "stable", np.concatenate([r.stable for r in found]))

    def plot(
        self,
        axes: Axes | None = None,
        *,
        length: str = "",
        unit: str | None = None,
        marks: bool = True,
        jumps: bool = True,
        top: float | None = None,
    ) -> Axes:
        """All on one picture."""
        return drawing(self, "plot")(self, axes, length=length, unit=unit, marks=marks, jumps=jumps, top=top)

    def describe(self, unit: str | None = None) -> str:
        """The table as text."""
        rows = self.table(unit=unit)
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        return "\n".join(
            "  ".join(f"{cell:<{w}}" for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows
        )


def place_of(curves: Sequence[str], curve: str) -> int:
    if not curve:
        return 0
    if curve not in curves:
        raise InputError("is no curve of this", key="curve", value=curve, remedy=nearest(curve, curves))
    return list(curves).index(curve)
