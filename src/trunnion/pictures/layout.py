"""A line in space: shafts, forks and joint planes as one would sketch them, to scale."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from mpl_toolkits.mplot3d import proj3d
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from trunnion.arrays import Array, Flags
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.layout import Layout
from trunnion.driveline.quantities import DEGREE
from trunnion.errors import InputError
from trunnion.laws.hooke import QUARTER_TURN
from trunnion.pictures.draw_matplotlib import SMALL, TEXT, head, new_figure, through
from trunnion.pictures.looks import COLOURS, FAINT, INK
from trunnion.response.kinetostatics.chain import KinematicChain, chain
from trunnion.response.kinetostatics.frames import member_frames, turned_about_axis
from trunnion.response.kinetostatics.motion import drive_jet, walk

SHAFT_COLOURS = COLOURS[:6]
PLANE_COLOUR = "#888888"
TOP = 0.93
"""Share of the picture's height below its title."""
LETTERS = 120
"""In a line of the note below the picture."""
SIDES = np.array([-1.0, 1.0])
UNKNOWN_LENGTH = 1.0
"""Length [m] drawn for a shaft of unknown length where no other is known."""


@dataclass(frozen=True)
class _Joint:
    """A joint's centre, the shafts it joins, its plane's normal, the arms of its forks (unit vectors)."""

    name: str
    centre: Array
    before: Array
    behind: Array
    normal: Array
    arms: tuple[Array, Array] | None
    angle: float


@dataclass(frozen=True)
class _Label:
    """What is written beside a point in space, and on which side of it if there is room (1: above)."""

    anchor: Array
    text: str
    colour: str
    side: float


@dataclass(frozen=True)
class _LabelPlace:
    """A label's box (x0, y0, x1, y1) and the points of its leader, in pixels."""

    box: Array
    leader: Array


@dataclass(frozen=True)
class _Scene:
    """Joints in order, ends and names of the shafts between and around them, sense of rotation, joints elsewhere."""

    joints: list[_Joint]
    ends: list[tuple[Array, Array]]
    names: list[str]
    guessed: bool
    sense: float = 1.0
    left_out: Sequence[str] = ()


def sketch(
    subject: Driveline | Layout, *, input_angle: float = 0.0, lengths: Mapping[str, float] | None = None
) -> Figure:
    """Sketch the first shafts of a line that joints bend, between ratios, or a layout with homokinetic fork offsets.

    Parameters
    ----------
    subject : a driveline (its first shaft along x, its first joint bending it downwards), or a layout where
        it is.
    input_angle : at which the forks are drawn [rad].
    lengths : joint-to-joint lengths [m] by shaft of a driveline, where they are not those of tubes.

    Examples
    --------
    >>> import trunnion as tn
    >>> figure = tn.sketch(tn.catalogue("two-shaft-cardan"))
    >>> print(figure)
    Figure(860x520)
    """
    scene = _of_layout(subject, input_angle) if isinstance(subject, Layout) else _of_line(
        subject, input_angle, dict(lengths or {})
    )  # fmt: skip
    figure = new_figure(8.6, 5.2, layout=None)
    figure.subplots_adjust(left=0.0, right=1.0, bottom=0.0, top=TOP)
    axes: Any = figure.add_subplot(projection="3d")
    axes.set_proj_type("ortho")
    size = 0.16 * float(np.mean([np.linalg.norm(b - a) for a, b in scene.ends]))
    labels: list[_Label] = []
    for k, ((start, end), name) in enumerate(zip(scene.ends, scene.names, strict=True)):
        colour = SHAFT_COLOURS[k % len(SHAFT_COLOURS)]
        front = start + (size * _unit(end - start) if k else 0.0)
        back = end - (size * _unit(end - start) if k < len(scene.ends) - 1 else 0.0)
        through(axes, front, back, color=colour, linewidth=4, solid_capstyle="butt")
        if name:
            labels.append(_Label((start + end) / 2, name, colour, -1.0))
    for k, joint in enumerate(scene.joints):
        _plane(axes, joint, size)
        if joint.arms:
            for side, (arm, axis) in enumerate(zip(joint.arms, (-joint.before, joint.behind), strict=True)):
                _fork(axes, joint.centre, arm, axis, size, SHAFT_COLOURS[(k + side) % len(SHAFT_COLOURS)])
        else:
            axes.plot(*joint.centre[:, None], marker="o", color=INK, markersize=7)
        labels.append(_Label(joint.centre, f"{joint.name}\n{joint.angle / DEGREE:.4g}°", INK, 1.0))
    _arrow(axes, scene.ends[0], size, scene.sense)
    _frame(axes, scene)
    title = subject.name if isinstance(subject, Driveline) and subject.name else "layout"
    head(figure, f"{title}: forks at input angle {input_angle / DEGREE:.4g}°")
    notes = [f"not drawn, on another branch or behind a ratio: {', '.join(scene.left_out)}"] if scene.left_out else []
    notes += ["lengths between joints not all known: not to scale"] if scene.guessed else []
    figure.text(0.01, 0.01, fill("; ".join(notes), LETTERS), fontsize=SMALL, color=FAINT)
    _write_labels(figure, axes, scene, size, labels)
    return figure


def _of_line(line: Driveline, input_angle: float, lengths: dict[str, float]) -> _Scene:
    train = chain(line, lengths)
    frames = member_frames(train)
    bent = [member.train for member in train.members if member.joint >= 0]
    if not bent:
        raise InputError("has no joint to draw", element="driveline", remedy="add a HookeJoint")
    members = [m for m, member in enumerate(train.members) if member.train == bent[0]]
    joints = [train.members[m].joint for m in members if train.members[m].joint >= 0]
    known = [m.length for m in train.members if np.isfinite(m.length)]
    usual = float(np.mean(known)) if known else UNKNOWN_LENGTH
    fronts = [train.steps[train.steps[j].parent].member for j in joints]
    if len(set(fronts)) < len(fronts):
        raise InputError(
            "branches to two joints",
            element="driveline",
            remedy="draw a line without branches in front of a ratio",
        )
    inner = [train.members[m].length for m in members[1:-1]]
    lengths_drawn = [0.5 * usual, *(x if np.isfinite(x) else usual for x in inner), 0.5 * usual]
    points = [np.zeros(3)]
    for m, length in zip(members, lengths_drawn, strict=True):
        points.append(points[-1] + length * frames[m][0])
    drawn = _joints(train, joints, points[1:-1], frames, input_angle)
    names = [", ".join(train.members[m].shafts[:2]) for m in members]
    guessed = not all(np.isfinite(x) for x in inner)
    turning = walk(train, drive_jet(np.array([input_angle]), 1.0, 0.0, 1)).angle[train.steps[joints[0]].parent]
    sense = float(np.sign(turning[1][0]))  # behind a ratio
    left_out = [train.steps[m.joint].name for m in train.members if m.joint >= 0 and m.train != bent[0]]
    return _Scene(drawn, list(zip(points[:-1], points[1:], strict=True)), names, guessed, sense, left_out)


def _joints(
    train: KinematicChain, joints: list[int], centres: list[Array], frames: Array, input_angle: float
) -> list[_Joint]:
    motion = walk(train, drive_jet(np.array([input_angle]), 1.0, 0.0, 0))
    drawn = []
    for j, centre in zip(joints, centres, strict=True):
        step = train.steps[j]
        e, u, v = turned_about_axis(frames[train.steps[step.parent].member], step.plane)
        e2, u2, v2 = frames[step.member]
        arms = None
        if step.cross:
            chi, behind = motion.chi[j][0][0], motion.passed[j][0][0] + QUARTER_TURN
            arms = (np.cos(chi) * u + np.sin(chi) * v, np.cos(behind) * u2 + np.sin(behind) * v2)
        drawn.append(_Joint(step.name, centre, e, e2, v, arms, step.angle))
    return drawn


def _of_layout(layout: Layout, input_angle: float) -> _Scene:
    scene = _of_line(layout.driveline(), input_angle, layout.shaft_lengths(layout.driveline()))
    bent = np.flatnonzero(~layout.straight)
    # the line's own frame starts with x, −z, y: turn it onto the layout's first axis and first joint plane
    e = layout.axes[0]
    v = np.cross(layout.axes[bent[0]], layout.axes[bent[0] + 1]) if len(bent) else np.cross(e, [0.0, 0.0, 1.0])
    v = _unit(v - (v @ e) * e)
    sense = 1.0 if layout.right_handed else -1.0  # angles that count about −e mirror the line
    turn = np.stack([e, sense * v, np.cross(e, v)], axis=1)

    def moved(point: Array) -> Array:
        return layout.centres[0] + turn @ (point - scene.joints[0].centre)

    joints = [
        _Joint(
            joint.name, moved(joint.centre), turn @ joint.before, turn @ joint.behind, turn @ joint.normal,
            None if joint.arms is None else (turn @ joint.arms[0], turn @ joint.arms[1]), joint.angle,
        )
        for joint in scene.joints
    ]  # fmt: skip
    return _Scene(joints, [(moved(a), moved(b)) for a, b in scene.ends], scene.names, False, sense)


def _fork(axes: Any, centre: Array, arm: Array, away: Array, size: float, colour: str) -> None:
    """A fork: from the shaft's end out to both pins; ``away`` points from the joint into its shaft."""
    root, half = centre + size * away, 0.62 * size * arm
    for pin in (-half, half):
        look = {"color": colour, "linewidth": 2.4, "solid_capstyle": "round", "solid_joinstyle": "round"}
        through(axes, root, root + pin, centre + pin, **look)
    through(axes, centre - half, centre + half, color=INK, linewidth=1.4, marker="o", markersize=3.5)


def _plane(axes: Any, joint: _Joint, size: float) -> None:
    """The joint plane: the sector between the front shaft carried straight on and the shaft behind."""
    reach = 3.0 * size
    bend = np.cross(joint.normal, joint.before)
    turn = np.linspace(0, joint.angle, 16)[:, None]
    arc = joint.centre + reach * (np.cos(turn) * joint.before + np.sin(turn) * bend)
    sector = np.vstack([joint.centre, arc])
    axes.add_collection3d(Poly3DCollection([sector], facecolor=PLANE_COLOUR, alpha=0.35, edgecolor="none"))
    straight = joint.centre + 1.15 * reach * joint.before
    through(axes, joint.centre, straight, color=FAINT, linewidth=0.9, linestyle=(0, (5, 3)))


def _arrow(axes: Any, first: tuple[Array, Array], size: float, sense: float) -> None:
    """Sense of rotation about the first shaft."""
    e = _unit(first[1] - first[0])
    side = np.cross(e, [0.0, 0.0, 1.0])
    side = _unit(side if np.linalg.norm(side) > 1e-6 else np.cross(e, [0.0, 1.0, 0.0]))
    up = sense * np.cross(e, side)
    centre = first[0] + 0.25 * (first[1] - first[0])
    turn = np.radians(np.linspace(-150, 90, 50))[:, None]
    circle = centre + 0.8 * size * (np.cos(turn) * side + np.sin(turn) * up)
    through(axes, *circle, color=INK, linewidth=1.2)
    tip = circle[-1]
    back, outward = 0.3 * size * _unit(tip - circle[-3]), 0.16 * size * _unit(tip - centre)
    for barb in (tip - back - outward, tip - back + outward):
        through(axes, tip, barb, color=INK, linewidth=1.2)


def _write_labels(figure: Figure, axes: Any, scene: _Scene, size: float, labels: list[_Label]) -> None:
    """Labels in the plane of the picture, where they meet neither the line nor each other."""
    figure.draw_without_rendering()  # settles the projection and the size of the texts
    drawn = _pixels(axes, _outline(scene, size))
    reach = _fork_pixels(axes, size)
    inside = figure.bbox.width, figure.bbox.height * TOP
    halo = [withStroke(linewidth=2.5, foreground="#ffffff")]
    placed: list[_LabelPlace] = []
    for label in labels:
        text = figure.text(0, 0, label.text, color=label.colour, fontsize=SMALL, ha="center", va="center")
        text.set(linespacing=1.1, path_effects=halo, parse_math=False)  # measured before it is drawn
        extent = text.get_window_extent()
        anchor = _pixels(axes, label.anchor[None])[0]
        choices = _choices(anchor, np.array([extent.width, extent.height]), reach, label.side)
        best = min(choices, key=lambda place: _conflicts(place, drawn, placed, inside))
        placed.append(best)
        middle = (best.box[:2] + best.box[2:]) / 2
        text.set_position(tuple(figure.transFigure.inverted().transform(middle)))
        if np.linalg.norm(best.leader[-1] - best.leader[0]) > 0.6 * extent.height:
            ends = figure.transFigure.inverted().transform(best.leader[[0, -1]])
            figure.add_artist(Line2D(*ends.T, color=FAINT, linewidth=0.7))


def _choices(anchor: Array, extent: Array, reach: float, side: float) -> list[_LabelPlace]:
    """Places of a box above and below its point, the nearest on the wanted side first."""
    found = []
    for row, turn, shift in product(range(14), (1.0, -1.0), (0.0, -0.4, 0.4, -0.8, 0.8)):
        up = side * turn
        away = reach + 4 + extent[1] / 2 + 0.5 * row * extent[1]
        middle = anchor + np.array([shift * extent[0], up * away])
        near = np.array([np.clip(anchor[0], *(middle[0] + extent[0] / 2 * SIDES)), middle[1] - up * extent[1] / 2])
        leader = np.linspace(anchor + reach * _unit(near - anchor), near, 24)
        cost = row + 5 * (turn < 0) + 8 * abs(shift)
        found.append((cost, _LabelPlace(np.concatenate([middle - extent / 2, middle + extent / 2]), leader)))
    return [place for _, place in sorted(found, key=lambda pair: pair[0])]


def _conflicts(place: _LabelPlace, drawn: Array, placed: list[_LabelPlace], inside: tuple[float, float]) -> float:
    """What a place runs into: points of the line, labels and their leaders, the picture's edge."""
    x0, y0, x1, y1 = place.box
    count = float(np.sum(_within(drawn, place.box, 4)))
    count += 1000.0 * (x0 < 2 or y0 < 2 or x1 > inside[0] - 2 or y1 > inside[1])
    for other in placed:
        a0, b0, a1, b1 = other.box
        count += 100.0 * (x0 < a1 + 4 and a0 < x1 + 4 and y0 < b1 + 2 and b0 < y1 + 2)
        count += float(np.sum(_within(other.leader, place.box, 3)) + np.sum(_within(place.leader, other.box, 3)))
    return count


def _within(points: Array, box: Array, margin: float) -> Flags:
    return np.asarray(np.all((points > box[:2] - margin) & (points < box[2:] + margin), axis=1))


def _outline(scene: _Scene, size: float) -> Array:
    """Points of what is drawn and not to be written over: shafts, forks, shafts carried straight on, the arrow."""
    lines = [np.linspace(a, b, 80) for a, b in scene.ends]
    lines += [np.linspace(j.centre, j.centre + 3.45 * size * j.before, 30) for j in scene.joints]
    ball = 0.8 * size * np.vstack([np.eye(3), -np.eye(3)])
    first = scene.ends[0][0] + 0.25 * (scene.ends[0][1] - scene.ends[0][0])
    return np.vstack([*lines, *(centre + ball for centre in (first, *(j.centre for j in scene.joints)))])


def _pixels(axes: Any, points: Array) -> Array:
    x, y, _ = proj3d.proj_transform(*points.T, axes.get_proj())
    return np.asarray(axes.transData.transform(np.stack([x, y], axis=1)))


def _fork_pixels(axes: Any, size: float) -> float:
    """How far forks reach from a joint's centre in the picture."""
    corner = np.array([axes.get_xlim()[0], axes.get_ylim()[0], axes.get_zlim()[0]])
    across = _pixels(axes, corner + 0.62 * size * np.eye(3)) - _pixels(axes, corner[None])
    return float(np.max(np.linalg.norm(across, axis=1)))


def _frame(axes: Any, scene: _Scene) -> None:
    """Equal scales with room for the labels, and axes in metres."""
    points = np.vstack([p for pair in scene.ends for p in pair])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = np.maximum(0.22 * float(np.max(high - low)) - (high - low) / 2, 0.04 * float(np.max(high - low)))
    low, high = low - margin, high + margin
    for name, a, b in zip("xyz", low, high, strict=True):
        getattr(axes, f"set_{name}lim")(a, b)
        getattr(axes, f"set_{name}label")(f"{name} [m]", fontsize=TEXT, color=INK)
    axes.set_box_aspect(high - low, zoom=1.25)
    axes.view_init(elev=22, azim=-68)
    axes.tick_params(labelsize=SMALL, colors=FAINT)
    axes.locator_params(nbins=4)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.pane.set_facecolor("#ffffff")
        axis.pane.set_edgecolor("#dddddd")


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))
