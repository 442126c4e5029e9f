"""One point of a stability chart: multipliers on the unit circle, verdict, the mode that grows fastest."""

from __future__ import annotations

from typing import Any

from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.widgets import column, facts, pane
from trunnion.results.units import with_error


class Point:
    """Pictures and numbers of ``tn.stability`` at one speed."""

    def __init__(self) -> None:
        self.circle, self.mode, self.text = Canvas(), Canvas(), pane()
        self.panel = column(self.text, self.circle.panel, self.mode.panel)

    def set(self, data: Any, speed_unit: tuple[str, float]) -> None:
        """Show a point."""
        unit, factor = speed_unit
        self.circle.show(data["circle"])
        self.mode.show(data["growing"])
        self.text.object = facts(
            {
                "speed": f"{data['speed'] * factor:.6g} {unit}",
                "verdict": data["verdict"],
                "spectral radius": with_error(data["radius"], data["error"], most=10, beside=1.0),
                "growth per turn": f"{100 * data['per_turn']:.5g} %",
                "growth rate": f"{data['growth']:.6g} 1/s",
                "resonance": data["resonance"] or "none",
                "moduli of the multipliers": ", ".join(f"{abs(m):.9f}" for m in data["multipliers"]),
            }
        )
