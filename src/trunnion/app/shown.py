"""What the views show of a result, as plain arrays and texts; runs in the worker that holds the result."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

Plain = dict[str, Any]


def nothing(result: Any) -> None:
    """Nothing: the computation itself was wanted."""


def text(result: Any, **options: Any) -> str:
    """The result as it prints."""
    return str(result)


def sketch(result: Any) -> str:
    """The driveline as SVG."""
    from trunnion.plots.driveline_sketch import draw

    return _picture(draw(result), "svg").decode("utf-8")


def assessment(result: Any) -> Plain:
    """Verdict, checks and findings."""
    bind = result.binding
    return {
        "verdict": str(result.verdict),
        "sentence": result.sentence,
        "unit": result.unit,
        "binding": bind.name if bind else "",
        "element": bind.element if bind else "",
        "limit": bind.limit if bind else math.nan,
        "quantity": bind.unit if bind else "",
        "rows": result.table(),
        "rules": [
            f"{c.rule.formula}: {c.rule.source} ({c.rule.certainty}){'; ' + c.inputs if c.inputs else ''}"
            for c in result.checks
        ],
        "margin": [c.margin for c in result.checks],
        "required": [c.required_margin for c in result.checks],
        "findings": [str(f) for f in result.findings],
    }


def file(result: Any, ending: str, method: str, options: Plain, columns: tuple[str, ...]) -> bytes:
    """A picture (png, svg) or the data (csv, nc) of a result."""
    if ending in ("png", "svg"):
        return _picture(getattr(result, method)(**options), ending)
    if ending == "csv":
        if hasattr(result, "to_csv"):
            return _written(result.to_csv, "data.csv")
        data = result.data[list(columns)] if columns else result.data
        return data.to_dataframe().to_csv().encode()  # type: ignore[no-any-return]
    if hasattr(result, "save"):
        return _written(result.save, "data.nc")
    from trunnion.results.files import dataset_bytes

    return dataset_bytes(result.data)


def _written(write: Callable[[Path], Any], name: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        write(path)
        return path.read_bytes()


def report(result: Any) -> bytes:
    """The HTML report."""
    return str(result.html).encode()


def _picture(figure: Any, ending: str) -> bytes:
    from io import BytesIO

    figure = getattr(figure, "figure", figure)
    stream = BytesIO()
    figure.savefig(stream, format=ending, dpi=150)
    return stream.getvalue()


def torque_limits(result: Any) -> Plain:
    """Vibratory and largest torque over speed, by shaft."""
    return {
        "speed": result.speed,
        "springs": list(result.springs),
        "vibratory": result.vibratory_torque,
        "peak": result.peak_torque,
    }
