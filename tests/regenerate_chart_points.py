"""Recompute tests/data/chart_points.json: spectral radii at 2 000 random points of charts of random chains.

Run from the repository: ``PYTHONPATH=src:tests python tests/regenerate_chart_points.py`` (with heyoka).
Chains and boxes are drawn from a stated seed: two parameters of each chain span a box, twenty random points
of it are integrated in twist coordinates by heyoka in 80-bit arithmetic. Eigenvalues are taken in double
precision: their rounding grows near collisions as the chart's own error does, and is a million times smaller.
See ``oracles.chains`` for the equations. Two minutes on two cores.
"""

from __future__ import annotations

import json
import multiprocessing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from oracles.chains import Chain, ExtendedPrecision, random_chain

SEED, CHAINS, POINTS = 40144, 100, 20
TARGET = Path(__file__).parent / "data" / "chart_points.json"
PAIRS = [
    ("speed", "angle"), ("angle", "angle"), ("stiffness", "speed"), ("load", "angle"), ("inertia", "speed"),
    ("damping", "angle"), ("fork_offset", "angle"), ("speed", "damping"), ("stiffness", "inertia"),
]  # fmt: skip


def changed(chain: Chain, kind: str, place: int, value: float) -> Chain:
    """The chain with one of its numbers replaced."""
    if kind == "speed":
        return replace(chain, speed=value)
    numbers = list(getattr(chain, kind))
    numbers[place] = value
    return replace(chain, **{kind: numbers})


def path_of(chain: Chain, kind: str, place: int) -> str:
    """What the package calls that number."""
    if kind == "speed":
        return "speed"
    if kind == "angle":
        return f"HookeJoint {sum(bool(a) for a in chain.angle[: place + 1])}.angle"
    if kind in ("inertia", "load"):
        return f"Disk {place + 1}.{'inertia' if kind == 'inertia' else 'load_torque'}"
    return f"Shaft {place + 1}.{kind}"


def random_axis(rng: np.random.Generator, chain: Chain, kind: str, place: int) -> list[float]:
    """Ends of an axis about the chain's own value."""
    if kind == "speed":
        return [float(chain.speed * 0.8), float(chain.speed * 1.4)]
    own = getattr(chain, kind)[place]
    if kind == "angle":
        return [0.01, float(rng.uniform(0.3, 1.2))]
    if kind == "load":
        return [float(own - 0.02), float(own + 0.02)]
    if kind == "fork_offset":
        return [float(own - 0.5), float(own + 0.5)]
    return [float(own * 0.6), float(own * 1.7)]


def random_box(rng: np.random.Generator, chain: Chain, pair: tuple[str, str]) -> list[tuple[str, int, list[float]]]:
    """Two different numbers of the chain, of the kinds asked for, and their ranges."""
    bent = [i for i, a in enumerate(chain.angle) if a]
    if pair == ("angle", "angle") and len(bent) < 2:
        pair = ("speed", "angle")
    axes: list[tuple[str, int, list[float]]] = []
    for kind in pair:
        places = bent if kind == "angle" else [0] if kind == "speed" else list(range(chain.size))
        free = [p for p in places if all((kind, p) != (k, q) for k, q, _ in axes)]
        place = int(rng.choice(free))
        axes.append((kind, place, random_axis(rng, chain, kind, place)))
    return axes


PRECISE = ExtendedPrecision()


def entry(index: int) -> dict[str, Any]:
    """A chain, its box, the points and the reference radii."""
    rng = np.random.default_rng([SEED, index])
    chain = random_chain(rng)
    axes = random_box(rng, chain, PAIRS[index % len(PAIRS)])
    points = [[float(rng.uniform(*span)) for _, _, span in axes] for _ in range(POINTS)]
    radii = []
    for point in points:
        here = chain
        for (kind, place, _), value in zip(axes, point, strict=True):
            here = changed(here, kind, place, value)
        radii.append(float(np.abs(np.linalg.eigvals(PRECISE.monodromy(here).astype(float))).max()))
    return {
        "chain": chain.as_dict(),
        "axes": [[path_of(chain, kind, place), *span] for kind, place, span in axes],
        "points": points,
        "spectral_radius": radii,
    }


def main() -> None:
    """Write the file."""
    with multiprocessing.get_context("spawn").Pool() as pool:
        entries = pool.map(entry, range(CHAINS), chunksize=5)
    about = (
        "spectral radii at random points of two-parameter boxes of random chains, all by heyoka in 80-bit arithmetic; "
        "see tests/regenerate_chart_points.py"
    )
    body = ",\n".join(json.dumps(e, separators=(",", ":")) for e in entries)
    TARGET.write_text(f'{{"about": {json.dumps(about)}, "seed": {SEED}, "entries": [\n{body}\n]}}\n', encoding="utf-8")
    print(f"wrote {sum(len(e['points']) for e in entries)} points of {len(entries)} chains to {TARGET}")


if __name__ == "__main__":
    main()
