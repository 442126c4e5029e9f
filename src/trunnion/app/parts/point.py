"""One point of a stability chart: multipliers on the unit circle, verdict, the mode that grows fastest."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn

from trunnion.app.parts import figures
from trunnion.app.parts.pieces import column, facts, pane
from trunnion.results.units import with_error


class Point:
    """Pictures and numbers of ``tn.stability`` at one speed."""

    def __init__(self) -> None:
        self.circle = figures.plot(
            "real", "imaginary", title="multipliers", height=300, tools="pan,wheel_zoom,reset", match_aspect=True
        )
        self.circle.sizing_mode = "fixed"
        self.circle.width = 300
        turn = np.linspace(0, 2 * np.pi, 181)
        self.circle.line(np.cos(turn), np.sin(turn), color=figures.INK)
        self.multipliers = figures.source(x=[], y=[], size=[])
        dots = self.circle.scatter("x", "y", source=self.multipliers, size=10, color=figures.ORANGE)
        figures.hover(self.circle, [dots], [("modulus", "@size{0.000000}"), ("", "@x{0.00000} + @y{0.00000} i")])
        self.mode = figures.shape(300)
        self.shape = figures.source(x=[], cos=[], sin=[])
        self.mode.line("x", "cos", source=self.shape, color=figures.BLUE, line_width=2, legend_label="at the start")
        self.mode.line(
            "x", "sin", source=self.shape, color=figures.ORANGE, line_width=2, line_dash="dashed",
            legend_label="a quarter later",
        )  # fmt: skip
        self.mode.add_layout(self.mode.legend[0], "below")
        self.mode.legend[0].update(orientation="horizontal", location="top_left", border_line_color=None)
        self.text = pane()
        self.panel = column(
            self.text,
            pn.pane.Bokeh(self.circle, width=300, height=300),
            pn.pane.Bokeh(self.mode, sizing_mode="stretch_width"),
        )

    def set(self, data: Any, speed_unit: tuple[str, float]) -> None:
        """Show a point."""
        unit, factor = speed_unit
        z = data["multipliers"]
        figures.put(self.multipliers, {"x": z.real, "y": z.imag, "size": np.abs(z)})
        mode = data["mode"]
        figures.name_inertias(self.mode, data["names"])
        figures.put(self.shape, {"x": data["names"], "cos": mode.real, "sin": mode.imag})
        self.mode.title.text = "what grows first"
        self.text.object = facts(
            {
                "speed": f"{data['speed'] * factor:.6g} {unit}",
                "verdict": data["verdict"],
                "spectral radius": with_error(data["radius"], data["error"], most=10, beside=1.0),
                "growth per turn": f"{100 * data['per_turn']:.5g} %",
                "growth rate": f"{data['growth']:.6g} 1/s",
                "resonance": data["resonance"] or "none",
                "moduli of the multipliers": ", ".join(f"{abs(m):.9f}" for m in z),
            }
        )
