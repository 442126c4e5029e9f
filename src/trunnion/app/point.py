"""One point of a stability chart: multipliers on the unit circle, verdict, the mode that grows fastest."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn
from bokeh.models import ColumnDataSource, Span

from trunnion.app import figures


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
        self.multipliers = ColumnDataSource(data={"x": [], "y": [], "size": []})
        dots = self.circle.scatter("x", "y", source=self.multipliers, size=10, color=figures.ORANGE)
        figures.hover(self.circle, [dots], [("modulus", "@size{0.000000}"), ("", "@x{0.00000} + @y{0.00000} i")])
        self.mode = figures.plot("", "rotation, largest 1", height=300, x_range=[], tools="")
        self.mode.xaxis.major_label_orientation = 0.6
        self.shape = ColumnDataSource(data={"x": [], "cos": [], "sin": []})
        self.mode.line("x", "cos", source=self.shape, color=figures.BLUE, line_width=2, legend_label="at the start")
        self.mode.line(
            "x", "sin", source=self.shape, color=figures.ORANGE, line_width=2, line_dash="dashed",
            legend_label="a quarter later",
        )  # fmt: skip
        self.mode.add_layout(self.mode.legend[0], "below")
        self.mode.legend.orientation = "horizontal"
        self.mode.legend.location = "top_left"
        self.mode.legend.border_line_color = None
        self.mode.add_layout(Span(location=0, dimension="width", line_color=figures.FAINT))
        self.text = pn.pane.HTML("", sizing_mode="stretch_width")
        pictures = (
            pn.pane.Bokeh(self.circle, width=300, height=300),
            pn.pane.Bokeh(self.mode, sizing_mode="stretch_width"),
        )
        self.panel = pn.Column(self.text, *pictures, sizing_mode="stretch_width", margin=0)

    def set(self, data: Any, speed_unit: tuple[str, float]) -> None:
        """Show a point."""
        unit, factor = speed_unit
        z = data["multipliers"]
        figures.put(self.multipliers, {"x": z.real, "y": z.imag, "size": np.abs(z)})
        mode = data["mode"]
        if list(self.mode.x_range.factors) != data["names"]:
            self.mode.x_range.factors = data["names"]
        figures.put(self.shape, {"x": data["names"], "cos": mode.real, "sin": mode.imag})
        self.mode.title.text = "what grows first"
        rows = {
            "speed": f"{data['speed'] * factor:.6g} {unit}",
            "verdict": data["verdict"],
            "spectral radius": f"{data['radius']:.9f} ± {data['error']:.1e}",
            "growth per turn": f"{100 * data['per_turn']:.5g} %",
            "growth rate": f"{data['growth']:.6g} 1/s",
            "resonance": data["resonance"] or "none",
            "moduli of the multipliers": ", ".join(f"{abs(m):.9f}" for m in z),
        }
        cells = "".join(f"<tr><th>{k}</th><td data-value='{k}'>{figures.text(v)}</td></tr>" for k, v in rows.items())
        self.text.object = f"<table class='plain'>{cells}</table>"
