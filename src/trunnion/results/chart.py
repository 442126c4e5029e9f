"""A stability chart as a result: it introduces itself, answers anywhere, plots, saves and reloads."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from trunnion._version import __version__
from trunnion.arrays import Array, Codes, Complex
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps, loads
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.operation import Operation
from trunnion.driveline.parameters import Parameter, Term
from trunnion.errors import InputError
from trunnion.numerics.memory import require_memory
from trunnion.numerics.patches.patches import Box, Patch, PatchedFunction
from trunnion.results.chart_contents import what_is_wrong
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.files import read_dataset, save_numbers
from trunnion.results.result import Result
from trunnion.results.units import with_error
from trunnion.results.variables import Attribute, Variable, attributes
from trunnion.results.verdict import Verdict, flag_attributes
from trunnion.results.words import Words
from trunnion.writing import written_whole

if TYPE_CHECKING:
    import xarray as xr

Resample = Callable[[Array, Array], tuple[Array, Array, Complex, Codes]]
FORMAT = "trunnion stability chart 4"


WAYS = (
    'how it was built in the end: "patches", "smaller patches", "whole periods", "pixel by pixel" or '
    '"periodic steady states", about the line\'s own motion'
)
FOLDS = "(y, from, to) in x where the line's own motion folds back or is lost, on the rows searched"
COLUMN_FOLDS = "(x, from, to) in y where it folds back or is lost between neighbouring rows"
BYTES_A_PIXEL = 64
"""Radius, error, multiplier and verdict of a pixel, and what is stored beside them while it is filled."""


@dataclass(frozen=True)
class ChartPoint:
    """One point of a chart: ``interpolated`` from a patch, or integrated where there is none."""

    x: float
    y: float
    spectral_radius: float
    error_estimate: float
    verdict: Verdict
    multipliers: Complex
    interpolated: bool

    def __str__(self) -> str:
        return f"{self.verdict}: spectral radius {with_error(self.spectral_radius, self.error_estimate, beside=1.0)}"


@dataclass(frozen=True)
class SpotCheck:
    """Direct integration at random pixels: worst ratio of the difference to its estimate, worst difference."""

    points: int
    worst_ratio: float
    worst_difference: float


@labelled
class StabilityChart(Result):
    """Stability over two parameters, axes in SI units; a failed point keeps its place as NaN."""

    x: Array = coordinate("x", "{self.x_unit}", "{self.x_label}")
    y: Array = coordinate("y", "{self.y_unit}", "{self.y_label}")
    x_parameter: str | Parameter = internal("along x")
    y_parameter: str | Parameter = internal("along y")
    x_unit: str = internal("of the parameter along x")
    y_unit: str = internal("of the parameter along y")
    spectral_radius: Array = variable("y x", "1")
    error_estimate: Array = variable("y x", "1")
    critical_multiplier: Complex = internal("of largest modulus", "1", "y x")
    verdict: Codes = variable("y x", words="codes of Verdict", more=flag_attributes())
    speed: float | None = internal("fixed input speed where no axis is the speed", "rad/s")
    period: float = attribute("of input angle", "rad")
    tolerance: float = attribute("error asked of the multipliers")
    statically_twisted: bool = attribute("whether the line is twisted by its loads")
    remarks: tuple[str, ...] = internal("what was clipped or built anew")
    line: Driveline | None = internal("that was charted; None of a family of one's own")
    function: PatchedFunction = internal("the patches behind the pixels")
    evaluate_point: Callable[[float, float], ChartPoint] | None = internal("at any point", default=None, compare=False)
    resample: Resample | None = internal("on other pixels", default=None, compare=False)
    spot_check: SpotCheck | None = internal("direct integration at random pixels", default=None)
    way: str = attribute(WAYS, default="patches")
    folds: tuple[tuple[float, float, float], ...] = internal(FOLDS, default=())
    column_folds: tuple[tuple[float, float, float], ...] = internal(COLUMN_FOLDS, default=())
    unit: str = internal("of speeds in print", default="rad/s")

    @property
    def x_label(self) -> str:
        """Path or label of the parameter along x."""
        return _label(self.x_parameter)

    @property
    def y_label(self) -> str:
        """Path or label of the parameter along y."""
        return _label(self.y_parameter)

    def at(self, x: float, y: float) -> ChartPoint:
        """Stability at any point of the chart's box, with multipliers, to the chart's accuracy.

        Raises
        ------
        InputError : the point lies outside the box.
        """
        for label, value, along in ((self.x_label, x, self.x), (self.y_label, y, self.y)):
            if not isinstance(value, int | float | np.number):
                raise InputError("must be one number", key=label, value=value, remedy="ask point by point, or zoom")
            if not along.min() <= value <= along.max():
                raise InputError(
                    f"lies outside the chart, which covers {along.min():.6g} to {along.max():.6g}",
                    key=label,
                    value=float(value),
                    remedy="compute a larger chart",
                )
        if self.evaluate_point is None:
            raise InputError("was read without its family and cannot be evaluated between pixels", element="chart")
        return self.evaluate_point(float(x), float(y))

    def zoom(self, x: Sequence[float | str], y: Sequence[float | str]) -> StabilityChart:
        """The same chart on other pixels: ``x`` and ``y`` are (low, high, points) inside its box.

        Pixels are spaced as the chart's own, or as ``"linear"`` or ``"log"`` at the end says. Patches are only
        evaluated anew; nothing is integrated where there are patches.
        """
        require_pixels(*(r[2] for r in (x, y) if len(r) > 2 and isinstance(r[2], int | float) and _is_number(r[2])))
        return self.on(_inside(self.x, x, self.x_label), _inside(self.y, y, self.y_label))

    def on(self, x: Array, y: Array) -> StabilityChart:
        """The same chart on pixels at rising values ``x`` and ``y`` inside its box."""
        require_pixels(len(x), len(y))
        if self.resample is None:
            raise InputError("was read without its family and cannot be resampled", element="chart")
        radius, error, critical, verdict = self.resample(x, y)
        return replace(
            self, x=x, y=y, spectral_radius=radius, error_estimate=error, critical_multiplier=critical, verdict=verdict
        )

    def count(self, verdict: Verdict) -> int:
        """Number of points with that verdict."""
        return int(np.count_nonzero(self.verdict == verdict))

    @property
    def unstable_share(self) -> float:
        """Share of unstable points."""
        return self.count(Verdict.UNSTABLE) / self.verdict.size

    def declared(self) -> Iterator[Variable | Attribute]:
        """Radius, error, critical multiplier and verdict over both parameters; settings, driveline and remarks."""
        yield from super().declared()
        yield Variable("critical_multiplier_real", self.critical_multiplier.real, "y x", "1")
        yield Variable("critical_multiplier_imaginary", self.critical_multiplier.imag, "y x", "1")
        yield from attributes(
            format=FORMAT,
            version=__version__,
            remarks=json.dumps(list(self.remarks)),
            driveline="" if self.line is None else dumps(self.line),
            x_parameter=_parameter_text(self.x_parameter),
            y_parameter=_parameter_text(self.y_parameter),
            speed=float("nan") if self.speed is None else self.speed,
            spot_check=json.dumps(asdict(self.spot_check) if self.spot_check else None),
            folds=json.dumps(self.folds),
            column_folds=json.dumps(self.column_folds),
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write netCDF-4, patches included; an existing file is replaced only when all is written."""
        save_numbers([*self.declared(), *_declared_patches(self.function)], path)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """One line per point: x, y, spectral radius, error estimate, verdict."""
        header = [
            f"{self.x_label} [{self.x_unit}]",
            f"{self.y_label} [{self.y_unit}]",
            "spectral radius",
            "error estimate",
            "verdict",
        ]
        words = {int(v): str(v) for v in Verdict}
        with written_whole(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            writer.writerow(header)
            for i, y in enumerate(self.y.tolist()):
                rows = zip(self.spectral_radius[i].tolist(), self.error_estimate[i].tolist(), strict=True)
                for x, code, (radius, error) in zip(self.x.tolist(), self.verdict[i].tolist(), rows, strict=True):
                    writer.writerow([x, y, radius, error, words[code]])

    def plot(
        self,
        axes: Axes | None = None,
        *,
        unit: str | None = None,
        resonances: Iterable[Any] | None = None,
        operating: Operation | None = None,
        tongues: Any = None,
    ) -> Axes:
        """Draw the chart (dark = unstable); see ``pictures.stability_chart``."""
        return drawing(self, "plot")(self, axes, unit=unit, resonances=resonances, operating=operating, tongues=tongues)

    def _lines(self) -> Iterator[str]:
        words = self.words if self.line else Words(None)
        across, up = words.parameter(self.x_label, self.x_unit), words.parameter(self.y_label, self.y_unit)
        counts = ", ".join(f"{n} {v}" for v in Verdict if (n := self.count(v)))
        yield f"stability chart, {self.x_label} × {self.y_label}, {len(self.x)} × {len(self.y)} points: {counts}"
        if np.isfinite(self.spectral_radius).any():
            worst = np.unravel_index(np.nanargmax(self.spectral_radius), self.spectral_radius.shape)
            yield (
                f"  largest spectral radius {self.spectral_radius[worst]:.6g} ± {self.error_estimate[worst]:.1e} at "
                f"{self.x_label} = {across.number(float(self.x[worst[1]]))}, "
                f"{self.y_label} = {up.number(float(self.y[worst[0]]))}"
            )
            middle = np.nanmedian(self.error_estimate)
            yield f"  error estimate {middle:.1e} (median), {np.nanmax(self.error_estimate):.1e} (worst)"
        if count := len(self.function.patches):
            evaluated = f" from {self.function.evaluations} integrations" if self.function.evaluations else ""
            yield f"  {count} patch{'es' if count > 1 else ''}{evaluated}"
        if (checked := self.check_sentence) is not None:
            yield f"  {checked}"
        yield from (f"  note: {remark}" for remark in self.remarks)

    @property
    def check_sentence(self) -> str | None:
        """What the chart's check of itself at random points found."""
        if self.spot_check is None:
            return None
        return (
            f"checked at {self.spot_check.points} random points by direct integration: differences up to "
            f"{self.spot_check.worst_ratio:.2g} of their estimates"
        )


def require_pixels(*points: float) -> None:
    """Refuse a grid of that many points per axis where its arrays would not fit; before any is made.

    Raises
    ------
    InputError : names the memory it would need.
    """
    needed = BYTES_A_PIXEL * float(np.prod([float(p) for p in points]))
    shown = " x ".join(f"{p:.0f}" for p in points)
    require_memory(needed, element="chart", key="points", value=shown, remedy="ask for fewer points, and zoom in later")


def read_chart(path: str | os.PathLike[str]) -> StabilityChart:
    """Read what ``StabilityChart.save`` wrote, without the means to integrate new points."""
    data = read_dataset(path, FORMAT)
    remedy = "give a saved chart, or compute it again"
    try:
        chart = _chart_of(data)
        wrong = what_is_wrong(chart)
    except (KeyError, ValueError, TypeError, AttributeError, IndexError, RecursionError):  # of another hand
        raise InputError("is not a whole stability chart", key=str(path), remedy=remedy) from None
    if wrong:
        raise InputError(
            f"is not a stability chart that this program could have saved: {wrong}", key=str(path), remedy=remedy
        )
    return chart


def _chart_of(data: xr.Dataset) -> StabilityChart:
    check = json.loads(data.attrs["spot_check"])
    speed = float(data.attrs["speed"])
    line = loads(text) if (text := data.attrs["driveline"]) else None
    return StabilityChart(
        x=data["x"].values,
        y=data["y"].values,
        x_parameter=_parameter_of(data.attrs["x_parameter"]),
        y_parameter=_parameter_of(data.attrs["y_parameter"]),
        x_unit=data["x"].attrs.get("units", ""),
        y_unit=data["y"].attrs.get("units", ""),
        spectral_radius=data["spectral_radius"].values,
        error_estimate=data["error_estimate"].values,
        critical_multiplier=data["critical_multiplier_real"].values + 1j * data["critical_multiplier_imaginary"].values,
        verdict=data["verdict"].values.astype(np.int8),
        speed=None if np.isnan(speed) else speed,
        period=float(data.attrs["period"]),
        tolerance=float(data.attrs["tolerance"]),
        statically_twisted=bool(data.attrs["statically_twisted"]),
        remarks=tuple(json.loads(data.attrs["remarks"])),
        line=line,
        unit=speed_unit(line) if line else "rad/s",
        function=_function_of(data),
        spot_check=SpotCheck(**check) if check else None,
        way=str(data.attrs["way"]),
        folds=_folds(data, "folds"),
        column_folds=_folds(data, "column_folds"),
    )


def _folds(data: xr.Dataset, name: str) -> tuple[tuple[float, float, float], ...]:
    return tuple((float(at), float(a), float(b)) for at, a, b in json.loads(data.attrs.get(name, "[]")))


def _function_of(data: xr.Dataset) -> PatchedFunction:
    boxes = [Box(*map(float, row)) for row in data["patch_box"].values]
    direct = tuple(Box(*map(float, row)) for row in data["direct_box"].values)
    if not boxes:
        return PatchedFunction((), direct)
    parts = zip(boxes, data["patch_coefficients"].values, data["patch_error"].values, strict=True)
    return PatchedFunction(tuple(Patch(*part) for part in parts), direct)


def _declared_patches(function: PatchedFunction) -> Iterator[Variable]:
    """What a chart read from a file is evaluated by; not part of its dataset."""
    yield Variable("patch_box", _edges([p.box for p in function.patches]), "patch edge")
    yield Variable("direct_box", _edges(list(function.direct)), "direct edge")
    if function.patches:
        yield Variable("patch_coefficients", _stacked(function.patches), "patch quantity degree_v degree_u")
        yield Variable("patch_error", np.stack([p.error for p in function.patches]), "patch quantity block_v block_u")


def _stacked(patches: tuple[Patch, ...]) -> Array:
    """Coefficients of all patches in one array; patches keep only as many as they need, the rest are zero."""
    shape = np.max([p.coefficients.shape for p in patches], axis=0)
    out = np.zeros((len(patches), *shape))
    for k, patch in enumerate(patches):
        q, i, j = patch.coefficients.shape
        out[k, :q, :i, :j] = patch.coefficients
    return out


def _edges(boxes: list[Box]) -> Array:
    return np.array([[b.u0, b.u1, b.v0, b.v1] for b in boxes], dtype=float).reshape(len(boxes), 4)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool) and bool(np.isfinite(value))


def is_log(axis: Array) -> bool:
    """Whether pixels stand at equal ratios rather than at equal distances."""
    if len(axis) < 3 or axis[0] <= 0:
        return False
    even, ratios = (spaced(axis[0], axis[-1], len(axis)) for spaced in (np.linspace, np.geomspace))
    return not np.allclose(axis, even, rtol=1e-9, atol=0) and np.allclose(axis, ratios, rtol=1e-9, atol=0)


def _inside(axis: Array, request: Sequence[float | str], label: str) -> Array:
    scale = request[3] if len(request) == 4 else "log" if is_log(axis) else "linear"
    numbers = request[:3]
    if len(request) not in (3, 4) or not all(map(_is_number, numbers)) or scale not in ("linear", "log"):
        remedy = 'numbers, then "linear" or "log" if you like'
        raise InputError("must be (low, high, points)", key=label, value=tuple(request), remedy=remedy)
    low, high, points = float(numbers[0]), float(numbers[1]), int(numbers[2])
    if points != numbers[2]:
        raise InputError("must be a whole number of points", key=label, value=numbers[2])
    if scale == "log" and low <= 0:
        raise InputError("cannot start at or below zero", element=label, key="log axis", value=low)
    rising = low < high or (low == high and points == 1)
    if not (axis.min() <= low and rising and high <= axis.max()) or points < 1:
        raise InputError(
            f"does not lie inside the chart, which covers {axis.min():.6g} to {axis.max():.6g}",
            key=label,
            value=(low, high, points),
            remedy="give low < high inside it and at least one point",
        )
    return np.geomspace(low, high, points) if scale == "log" else np.linspace(low, high, points)


def _label(parameter: str | Parameter) -> str:
    return parameter if isinstance(parameter, str) else parameter.label


def _parameter_text(parameter: str | Parameter) -> str:
    return json.dumps(parameter if isinstance(parameter, str) else asdict(parameter))


def _parameter_of(text: str) -> str | Parameter:
    read = json.loads(text)
    if isinstance(read, str):
        return read
    return Parameter(read["label"], read["unit"], tuple(Term(**term) for term in read["terms"]))
