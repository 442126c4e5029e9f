"""Names with dollars, braces and backslashes appear as they are written, in every picture."""

from __future__ import annotations

import io

import numpy as np
import pytest
from matplotlib.figure import Figure
from oracles.sampling import quick_only

import trunnion as tn
from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.pictures.draw_matplotlib import new_figure
from trunnion.pictures.layout import sketch
from trunnion.reporting.pictures import picture

NAMES = ["load $a_$", "$x$", "$", "a$b$c$", r"$\frac{1}{$", "{", r"\alpha $\undefined$", "^$_^$"]

SIZE = (6.3, 4.9)


def line(name: str) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e4, name=f"s{name}"),
            tn.Disk(inertia=1.0),
            tn.HookeJoint(angle=0.2, name=f"j{name}"),
            tn.Shaft(stiffness=1e4),
            tn.Disk(inertia=1.0, name=name),
        ],
        name=name,
    )


@pytest.mark.parametrize(("name", "ending"), list(zip(NAMES, ["svg", "png", "pdf"] * 3, strict=False)))
def test_text_of_every_kind_is_shown_as_written(name, ending):
    axes = new_figure(*SIZE).add_subplot()
    axes.plot([1, 1e6], [1, 1e6], label=name)
    axes.set(xlabel=name, ylabel=name, title=name, xscale="log")
    axes.set_yticks([1, 2], [name, "b"])
    axes.annotate(name, (1, 1))
    axes.legend(title=name)
    stream = io.BytesIO()
    axes.figure.savefig(stream, format=ending, bbox_inches="tight")
    assert stream.tell() > 1000


def test_powers_at_the_axes_stay_powers():
    axes = new_figure(*SIZE).add_subplot()
    axes.set(xscale="log", xlim=(1, 1e6), title="$x$")
    axes.figure.draw_without_rendering()
    assert all(text.get_parse_math() for text in axes.get_xticklabels()) and not axes.title.get_parse_math()


@pytest.mark.parametrize("ending", quick_only(["svg"], ["svg", "png", "pdf"]))
def test_a_saved_figure_is_drawn_once_and_laid_out_as_matplotlib_would(ending, monkeypatch):
    def fill(axes):
        axes.plot([1, 1e6], [1, 1e6], label="a label")
        axes.set(xlabel="speed", ylabel="amplitude of something", title="title", xscale="log")
        axes.figure.legend(loc="outside lower left")

    axes, plain = new_figure(*SIZE).add_subplot(), Figure(figsize=SIZE, layout="constrained").add_subplot()
    fill(axes)
    fill(plain)
    plain.figure.savefig(io.BytesIO(), format=ending)
    drawn, draw = [], type(axes).draw
    monkeypatch.setattr(type(axes), "draw", lambda self, renderer: drawn.append(1) or draw(self, renderer))
    for _ in range(2):
        axes.figure.savefig(io.BytesIO(), format=ending)
    assert len(drawn) == 2
    np.testing.assert_allclose(axes.get_position().extents, plain.get_position().extents, atol=0.01)
    assert axes.figure.get_layout_engine() is not None
    axes.figure.draw_without_rendering()  # a user's own drawing, laid out as ever
    np.testing.assert_allclose(axes.get_position().extents, plain.get_position().extents, atol=0.01)


def test_drawings_of_a_line():
    for name in NAMES[::3]:
        for drawn in (sketch(line(name)), natural_frequencies(line(name)).plot()):
            figure = getattr(drawn, "figure", None) or drawn
            assert picture(figure, "alt").address.startswith("data:image/svg")
