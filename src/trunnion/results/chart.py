"""A stability chart as a result: it introduces itself, plots, saves and reloads."""

from __future__ import annotations

import csv
import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from trunnion._version import __version__
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps, loads
from trunnion.errors import InputError
from trunnion.results.files import written_whole
from trunnion.results.verdict import Verdict, flag_attributes

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
FORMAT = "trunnion stability chart 1"


@dataclass(frozen=True)
class StabilityChart:
    """Stability over two parameters; arrays have shape (y, x), axes in SI units.

    ``verdict`` holds the int8 codes of ``Verdict``; a failed point keeps its place as NaN. ``speed`` [rad/s]
    is the fixed input speed where no axis is the speed; ``period`` [rad] of input angle; ``remarks`` say what
    was clipped.
    """

    x: Array
    y: Array
    x_label: str
    y_label: str
    x_unit: str
    y_unit: str
    spectral_radius: Array
    error_estimate: Array
    verdict: NDArray[np.int8]
    speed: float | None
    period: float
    tolerance: float
    remarks: tuple[str, ...]
    line: Driveline

    def count(self, verdict: Verdict) -> int:
        """Number of points with that verdict."""
        return int(np.count_nonzero(self.verdict == verdict))

    @property
    def unstable_share(self) -> float:
        """Share of unstable points."""
        return self.count(Verdict.UNSTABLE) / self.verdict.size

    @property
    def data(self) -> xr.Dataset:
        """Labelled dataset with units, settings, driveline and error estimates."""
        import xarray as xr

        settings = {
            "format": FORMAT,
            "version": __version__,
            "period": self.period,
            "tolerance": self.tolerance,
            "remarks": json.dumps(list(self.remarks)),
            "driveline": dumps(self.line),
            "x_label": self.x_label,
            "y_label": self.y_label,
        }
        if self.speed is not None:
            settings["speed"] = self.speed
        return xr.Dataset(
            {
                "spectral_radius": (("y", "x"), self.spectral_radius, {"units": "1"}),
                "error_estimate": (("y", "x"), self.error_estimate, {"units": "1"}),
                "verdict": (("y", "x"), self.verdict, flag_attributes()),
            },
            coords={
                "x": ("x", self.x, {"units": self.x_unit, "long_name": self.x_label}),
                "y": ("y", self.y, {"units": self.y_unit, "long_name": self.y_label}),
            },
            attrs=settings,
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write netCDF (any netCDF-4 reader opens it); an existing file is replaced only when all is written."""
        with written_whole(path) as temporary:
            self.data.to_netcdf(temporary, engine="h5netcdf")

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
            for i, y in enumerate(self.y):
                for j, x in enumerate(self.x):
                    radius, error = float(self.spectral_radius[i, j]), float(self.error_estimate[i, j])
                    writer.writerow([repr(float(x)), repr(float(y)), radius, error, words[int(self.verdict[i, j])]])

    def plot(self, axes: Axes | None = None, **options: Any) -> Axes:
        """Draw the chart (dark = unstable); see ``plots.stability_chart.draw``."""
        from trunnion.plots.stability_chart import draw

        return draw(self, axes, **options)

    def __str__(self) -> str:
        worst = np.unravel_index(np.nanargmax(self.spectral_radius), self.spectral_radius.shape)
        counts = ", ".join(f"{n} {v}" for v in Verdict if (n := self.count(v)))
        lines = [
            f"stability chart, {self.x_label} × {self.y_label}, {len(self.x)} × {len(self.y)} points: {counts}",
            f"  largest spectral radius {self.spectral_radius[worst]:.6g} ± {self.error_estimate[worst]:.1e} at "
            f"{self.x_label} = {self.x[worst[1]]:.6g} {self.x_unit}, "
            f"{self.y_label} = {self.y[worst[0]]:.6g} {self.y_unit}",
            f"  largest error estimate {np.nanmax(self.error_estimate):.1e}",
        ]
        return "\n".join([*lines, *(f"  note: {r}" for r in self.remarks)])

    __repr__ = __str__


def load_chart(path: str | os.PathLike[str]) -> StabilityChart:
    """Read a chart that ``StabilityChart.save`` wrote."""
    import xarray as xr

    try:
        with xr.open_dataset(path, engine="h5netcdf") as opened:
            data = opened.load()
    except FileNotFoundError:
        raise InputError("does not exist", key="chart", value=str(path)) from None
    except (OSError, ValueError):
        raise InputError("is not a netCDF file", key="chart", value=str(path)) from None
    if data.attrs.get("format") != FORMAT:
        raise InputError("is not a stability chart of this program", key="chart", value=str(path))
    return StabilityChart(
        x=data["x"].values,
        y=data["y"].values,
        x_label=data.attrs["x_label"],
        y_label=data.attrs["y_label"],
        x_unit=data["x"].attrs["units"],
        y_unit=data["y"].attrs["units"],
        spectral_radius=data["spectral_radius"].values,
        error_estimate=data["error_estimate"].values,
        verdict=data["verdict"].values.astype(np.int8),
        speed=float(data.attrs["speed"]) if "speed" in data.attrs else None,
        period=float(data.attrs["period"]),
        tolerance=float(data.attrs["tolerance"]),
        remarks=tuple(json.loads(data.attrs["remarks"])),
        line=loads(data.attrs["driveline"]),
    )
