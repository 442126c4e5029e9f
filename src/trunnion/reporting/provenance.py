"""Where a report comes from: version, settings, time, and a hash of the description."""

from __future__ import annotations

import hashlib
import platform
from datetime import datetime
from pathlib import Path

import numpy as np

from trunnion._version import __version__
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps
from trunnion.reporting.contents import Contents


def provenance(contents: Contents, source: Path | None, made: datetime) -> list[tuple[str, str]]:
    """Rows of name and text. The hash is that of the file's bytes, or of the line written as TOML."""
    name, digest = fingerprint(contents.overview.line, source)
    rows = [
        ("made", made.strftime("%Y-%m-%d %H:%M %Z").strip()),
        ("program", f"Trunnion {__version__}, Python {platform.python_version()}, NumPy {np.__version__}"),
        ("description", name),
        ("SHA-256 of it", digest),
        ("period of the line", f"{_period(contents)} of input angle"),
    ]
    chart = contents.overview.chart
    if chart is not None:
        worst = f"{np.nanmax(chart.error_estimate):.1e}" if np.isfinite(chart.error_estimate).any() else "unknown"
        twisted = "statically twisted by the loads" if chart.statically_twisted else "untwisted"
        rows += [
            ("linearised about", f"the line turning evenly, {twisted}"),
            ("chart", f"{len(chart.x)} × {len(chart.y)} points, tolerance {chart.tolerance:g}, largest error of a "
             f"spectral radius {worst}"),
        ]  # fmt: skip
        if chart.spot_check is not None:
            rows.append(
                ("self-check", f"{chart.spot_check.points} random points integrated anew; they differ by up to "
                 f"{chart.spot_check.worst_ratio:.2g} of the estimated error; built as: {chart.way}")
            )  # fmt: skip
    if contents.limit is not None:
        rows.append(("limit angle", contents.limit.search))
    return rows


def fingerprint(line: Driveline, source: Path | None) -> tuple[str, str]:
    """What the description is called, and its SHA-256."""
    if source is not None and source.is_file():
        return source.name, hashlib.sha256(source.read_bytes()).hexdigest()
    return "a driveline built in Python or of the catalogue, written as TOML", hashlib.sha256(
        dumps(line).encode()
    ).hexdigest()


def _period(contents: Contents) -> str:
    turns = contents.overview.assembly.topology.period_turns()
    return f"{turns} turn" if turns <= 1 else f"{turns} turns"
