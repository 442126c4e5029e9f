"""An animated picture of a line in motion, drawn by Pillow: for mails and slides. The page shows more."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from trunnion.animation.movement import Movement
from trunnion.animation.movements import GROWN
from trunnion.animation.scene import ShownMotion
from trunnion.animation.scenery import DrawnPart
from trunnion.arrays import Array, Complex

TURN, RISE = -0.62, 0.36
"""From where one looks [rad], as the player does at first."""
RATE, MOST_FRAMES = 20, 240
"""Frames a second, and at most."""
FINE = 2
"""Drawn so many times larger, then made smaller."""
ROUND = 28
GROUND, INK, EDGE, STEEL, DARK, GEAR, JOINT, MARK, TIE = (
    "#f7f9fb", "#1a1a1a", "#5b6b78", "#9db7c9", "#5b6b78", "#c8b27a", "#c9a24b", "#ffffff", "#c5ccd3"
)  # fmt: skip
LOW, NONE, HIGH = np.array([0, 114, 178]), np.array([214, 214, 214]), np.array([213, 94, 0])
"""Colours of torque: against the twist, none, with it."""


@dataclass(frozen=True)
class _Piece:
    """A line through points (n, 3), or an area between them; ``wide`` in the picture's unit, 0 for an area."""

    points: Array
    colour: str
    wide: float = 0.0
    edge: str = ""


def write(shown: ShownMotion, path: Path, *, seconds: float, width: int, title: str) -> None:
    """Write one loop of a motion as a GIF."""
    from PIL import Image

    movements = shown.movements
    frames = int(np.clip(round(RATE * seconds), 2, MOST_FRAMES))
    height = round(width * (0.42 if len(movements) == 1 else 0.72)) + 22
    view = _View(shown.parts, width * FINE, round((height - 22) * FINE / len(movements)))
    pictures = []
    for k in range(frames):
        whole = Image.new("RGB", (width * FINE, height * FINE), GROUND)
        for row, movement in enumerate(movements):
            view.draw(whole, shown.parts, movement, k / frames, row)
        _write_title(whole, title, shown, height)
        pictures.append(whole.resize((width, height), Image.Resampling.LANCZOS))
    plain = Image.Dither.NONE
    first = pictures[0].quantize(64, dither=plain)
    rest = [one.quantize(palette=first, dither=plain) for one in pictures[1:]]
    first.save(path, format="GIF", save_all=True, append_images=rest, duration=round(1000 * seconds / frames), loop=0)


def _write_title(whole: Any, title: str, shown: ShownMotion, height: int) -> None:
    from matplotlib import get_data_path
    from PIL import ImageDraw, ImageFont

    font = ImageFont.truetype(str(Path(get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"), 12 * FINE)
    words = ", ".join(dict.fromkeys([title, *(movement.title for movement in shown.movements)]))
    one = shown.movements[0]
    drawn = "size arbitrary" if one.arbitrary else f"twist drawn {one.factor:g} ×" if one.factor != 1 else ""
    text = "; ".join(part for part in (words, drawn) if part)
    ImageDraw.Draw(whole).text((8 * FINE, (height - 19) * FINE), text, fill=INK, font=font)


def state(movement: Movement, share: float) -> tuple[Array, Array]:
    """Angles as drawn (station,) [rad] and torques (spring,) [N m] at a share of the whole motion, from 0 to 1."""
    span, unit = float(movement.time[-1] - movement.time[0]), 1.0
    at = share * span
    if movement.growth is None:
        wave: complex = 1.0
    else:
        rate = movement.growth.real
        whole = np.log(GROWN) / abs(rate) if rate else span
        unit = 1 / GROWN if rate > 0 else 1.0
        wave = complex(unit * np.exp(movement.growth * share * whole))
        at = (share * whole) % span
    times = movement.time - movement.time[0]

    def between(part: Array | Complex) -> Array:
        found = [np.interp(at, times, column.real) + 1j * np.interp(at, times, column.imag) for column in part.T]
        return np.real(np.array(found) * wave)

    rigid = np.array([np.interp(at, times, column) for column in movement.rigid.T])
    return rigid + movement.factor * between(movement.deviation), between(movement.torque)


class _View:
    """A camera that has all of the line in view, for pictures ``wide`` × ``tall`` [pixels]."""

    def __init__(self, parts: tuple[DrawnPart, ...], wide: int, tall: int) -> None:
        out = np.array([np.sin(TURN) * np.cos(RISE), -np.cos(TURN) * np.cos(RISE), np.sin(RISE)])
        right = np.array([np.cos(TURN), np.sin(TURN), 0.0])
        self.axes = np.stack([right, np.cross(out, right), out])
        self.wide, self.tall = wide, tall
        reach = np.vstack([p for part in parts for p in _corners(part)]) if parts else np.zeros((1, 3))
        seen = reach @ self.axes.T
        low, high = seen.min(axis=0), seen.max(axis=0)
        self.middle = (low + high) / 2
        self.scale = 0.92 * min(wide / max(high[0] - low[0], 1e-9), tall / max(high[1] - low[1], 1e-9))

    def draw(self, whole: Any, parts: tuple[DrawnPart, ...], movement: Movement, share: float, row: int) -> None:
        """The line at a share of a motion, as the row of that number."""
        from PIL import ImageDraw

        pencil = ImageDraw.Draw(whole)
        angles, torque = state(movement, share)
        most = float(np.abs(movement.torque).max(initial=0.0))
        out = self.axes[2]
        for part in sorted(parts, key=lambda one: float(_middle(one) @ out)):
            tint = STEEL if part.spring < 0 or not most else _tint(float(torque[part.spring]) / most)
            for piece in _pieces(part, angles, tint, out):
                self._draw(pencil, piece, row)

    def _draw(self, pencil: Any, piece: _Piece, row: int) -> None:
        seen = piece.points @ self.axes.T
        x = self.wide / 2 + (seen[:, 0] - self.middle[0]) * self.scale
        y = (row + 0.5) * self.tall - (seen[:, 1] - self.middle[1]) * self.scale
        points = list(zip(x.tolist(), y.tolist(), strict=True))
        if not piece.wide:
            pencil.polygon(points, fill=piece.colour, outline=piece.edge or None, width=FINE)
            return
        thick = max(1, round(piece.wide * self.scale))
        if piece.edge:
            pencil.line(points, fill=piece.edge, width=thick + 2 * FINE)
        pencil.line(points, fill=piece.colour, width=thick, joint="curve")


def _middle(part: DrawnPart) -> Array:
    """Where a body stands among others, the nearest drawn last."""
    return (
        part.at + 0.5 * part.size.get("length", 0.0) * part.frame[0] if part.far is None else (part.at + part.far) / 2
    )


def _corners(part: DrawnPart) -> Iterator[Array]:
    radius = max(part.size.get("radius", 0.1), part.size.get("reach", 0.0))
    ends = [part.at, part.at + part.size.get("length", 0.0) * part.frame[0]]
    for at in [*ends, *([part.far] if part.far is not None else [])]:
        yield from (at + radius * side * axis for axis in part.frame[1:] for side in (1, -1))


def _tint(share: float) -> str:
    end = LOW if share < 0 else HIGH
    red, green, blue = (NONE + min(abs(share), 1.0) * (end - NONE)).round().astype(int).tolist()
    return f"#{red:02x}{green:02x}{blue:02x}"


def _put(at: Array, frame: Array, angle: float, places: Array) -> Array:
    """Places (n, 3), along the axis and across it in the turned frame, in space."""
    e, u, v = frame
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(at + places @ np.stack([e, c * u + s * v, -s * u + c * v]))


def _circle(x: float, radius: float) -> Array:
    turn = np.linspace(0.0, 2 * np.pi, ROUND + 1)
    return np.stack([np.full(len(turn), x), radius * np.cos(turn), radius * np.sin(turn)], axis=1)


def _pieces(part: DrawnPart, angles: Array, tint: str, out: Array) -> Iterator[_Piece]:
    """What is drawn of one body, the farthest first; ``out`` points to the eye."""
    own = [float(angles[s]) - off for s, off in zip(part.stations, part.turned, strict=True)]
    length, radius = part.size.get("length", 0.0), part.size.get("radius", 0.1)

    def put(places: Any, which: int = 0) -> Array:
        frame = part.back if which and part.back is not None else part.frame
        return _put(part.at, frame, own[which], np.array(places, dtype=float))

    towards = bool(part.frame[0] @ out > 0)

    def drum(first: float, last: float, colour: str, which: int = 0) -> Iterator[_Piece]:
        far, near = (first, last) if towards else (last, first)
        yield _Piece(put(_circle(far, radius), which), colour, edge=EDGE)
        across = np.cross(part.frame[0], out)
        if np.linalg.norm(across) > 1e-9:
            side = radius * across / np.linalg.norm(across)
            ends = [part.at + x * part.frame[0] + way * side for x, way in ((far, 1), (near, 1), (near, -1), (far, -1))]
            yield _Piece(np.array(ends), colour, edge=EDGE)
        yield _Piece(put(_circle(near, radius), which), colour, edge=EDGE)
        yield _Piece(put([[near, 0, 0], [near, 0.95 * radius, 0]], which), MARK, 0.06)

    match part.shape:
        case "disk" | "ring" | "throw" | "drive" | "gear" | "rim":
            colour = {"drive": DARK, "gear": GEAR, "rim": GEAR}.get(part.shape, STEEL)
            yield _Piece(put([[-0.15, 0, 0], [length + 0.15, 0, 0]]), DARK, 0.16)
            yield from drum(0.0, length, tint if part.spring >= 0 else colour)
        case "plates":
            halves = [drum(0.0, length / 2, DARK), drum(length / 2, length, tint, 1)]
            for half in halves if towards else reversed(halves):
                yield from half
        case "shaft" | "coupling":
            thick = radius if part.shape == "shaft" else max(2.2 * radius, 0.24)
            yield _Piece(put([[0, 0, 0], [length, 0, 0]]), tint, 2 * thick, EDGE)
            for side in (0.0, np.pi):
                x = np.linspace(0.0, 1.0, 13)
                turn = side + x * (own[1] - own[0])
                stripe = np.stack([x * length, thick * np.cos(turn), thick * np.sin(turn)], axis=1)
                whole = (turn + own[0])[:, None]
                in_front = (np.cos(whole) * part.frame[1] + np.sin(whole) * part.frame[2]) @ out > 0
                for k in range(len(x) - 1):
                    if in_front[k]:
                        yield _Piece(put(stripe[k : k + 2]), INK, 0.03)
        case "cross" | "joint":
            reach = part.size["reach"]
            forks = [(0, -1.0, DARK), (1, 1.0, GEAR)]
            for which, way, colour in forks if towards else forks[::-1]:
                root = 0.4 * way * reach
                yield _Piece(put([[way * reach, 0, 0], [root, 0, 0]], which), colour, 0.16)
                fork = [[0, radius, 0], [root, radius, 0], [root, -radius, 0], [0, -radius, 0]]
                yield _Piece(put(fork, which), colour, 0.07)
                yield _Piece(put([[0, radius, 0], [0, -radius, 0]], which), JOINT, 0.07)
        case "tie" | "link" | "belt":
            assert part.far is not None
            yield _Piece(np.stack([part.at, part.far]), TIE if part.shape == "tie" else tint, 0.08)
