"""The page beside the report on which the line moves: a file of its own, since the report runs no script."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from trunnion.animation.animate import animate
from trunnion.animation.animation import Animation, together
from trunnion.driveline.driveline import Driveline
from trunnion.errors import TrunnionError

MOST_MODES = 4


def live(line: Driveline, speed: float | None = None) -> tuple[Animation, tuple[str, ...]]:
    """What the line can be seen to do at a speed [rad/s], default its operating speed: turn, swing in its lowest modes,
    answer what excites it, let a disturbance grow or die out. Also, sentence by sentence, what it cannot and why."""
    asked: list[tuple[str, dict[str, Any]]] = [("turning", {"speed": speed})]
    asked += [("mode", {"mode": number}) for number in range(1, MOST_MODES + 1)]
    asked += [(what, {"speed": speed}) for what in ("response", "disturbance")]
    found, left_out, refused = list[Animation](), list[str](), set[str]()
    for what, arguments in asked:
        if what in refused:
            continue
        try:
            found.append(animate(line, what, **arguments))
        except TrunnionError:
            refused.add(what)
            if what == "response":
                refused.add("disturbance")
                try:
                    found.append(animate(line, "motion", speed=speed))
                    continue
                except TrunnionError as second:
                    error = second
            if what != "mode" or arguments["mode"] == 1:
                left_out.append(f"{what} in motion: {error}")
    return together(line.name or "driveline", found), tuple(left_out)


def beside(report: Path) -> Path:
    """Where that page stands beside a report."""
    return report.with_name(f"{report.stem.removesuffix('-report')}-live.html")
