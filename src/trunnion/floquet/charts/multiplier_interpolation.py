"""Charts of stiff lines from few monodromy matrices over whole periods.

Slabs follow every mode of a line, though most die within a period and have no part in its stability. Here the largest
multipliers alone are interpolated, as one group (see ``leading_group``), on grids whose degree each direction chooses
for itself; the matrices come from exponential steps, whose number the joints set and not the fastest mode.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.first_order import LineRates
from trunnion.floquet.charts.cost_model import HALVINGS, pixel_cost, step_cost
from trunnion.floquet.charts.leading_group import ConvergingMultipliers, GridPoints, group_sizes, known, settle
from trunnion.numerics.chain.exponential_monodromy import MOST_STEPS
from trunnion.numerics.patches.nested import FIRST_DEGREES, HIGHEST_DEGREE, ChebyshevSeries, Grid
from trunnion.numerics.patches.patches import Box, Patch, PatchedFunction

AtNodes = Callable[[Array, Array], GridPoints]
"""Nodes (u, v) → points to be stepped."""
DEEPEST = 3
"""Halvings of a box in which no group stands apart or whose degrees would be too high."""
LIKELY_STEPS = 64
"""Steps of a period that most lines need."""
SHARE = 0.7
"""Of what the other ways cost, what may be spent before this one is given up."""
REFINED = 2
"""Nodes of a grid whose series has faded, over those that the forecast asks for."""
PROBES = 16
"""Input angles at which A is averaged for a forecast."""


def leading_patches(
    points: AtNodes,
    corners: LineRates,
    box: Box,
    pixels: int,
    tolerance: float,
    threads: int,
    cost_elsewhere: float,
    report_progress: Callable[[float], None],
    even_all: bool = False,
) -> PatchedFunction | None:
    """Patches of the largest multipliers' e₁ … e_d over ``box``, each to ``tolerance`` of its size (1 at least).

    ``points``: what is charted at nodes (u, v); ``corners``: its equations at the ``corners_of`` the box.

    None where that costs more than ``cost_elsewhere`` [µs], no group of multipliers stands apart, or it holds them
    all and ``even_all`` is not asked for: elsewhere, then nothing is spared.
    """
    states = 2 * corners.root.shape[1]
    cost, spared = step_cost(states), cost_elsewhere - pixels * pixel_cost(6)
    group, nodes_expected = _forecast(corners)
    dearest = spared / (nodes_expected * HALVINGS * cost)
    if (group == states and not even_all) or not LIKELY_STEPS < dearest:
        return None
    each, most_work = _work_at(points(*corners_of(box)), group, tolerance, dearest), SHARE * spared / cost
    if not REFINED * nodes_expected * each < most_work:
        return None
    todo, patches = [(box, 0)], list[Patch]()
    nodes, work, whole = 0, 0.0, 0.0
    while todo:
        part, depth = todo.pop()
        made = _BoxRefinement(points, part, tolerance, threads, most_work - work)
        patch = made.patch()
        nodes, work = nodes + len(made.found.steps), work + made.found.work
        if patch is not None:
            patches.append(patch)
            whole += 0.5**depth
            report_progress(whole)
        elif work > most_work or depth == DEEPEST:
            return None
        else:
            todo += [(half, depth + 1) for half in part.halves(made.split_u, not made.split_u)]
    return PatchedFunction(tuple(_alike(patches)), (), nodes)


def corners_of(box: Box) -> tuple[Array, Array]:
    """u and v of the corners of a box."""
    return np.array([box.u0, box.u1, box.u0, box.u1]), np.array([box.v0, box.v0, box.v1, box.v1])


def _forecast(corners: LineRates) -> tuple[int, float]:
    """The size of the group and the nodes that a box will take, from the mean equations at its corners.

    Infinitely many where no group stands apart.
    """
    tau = corners.period * np.arange(PROBES) / PROBES
    mean = corners(np.arange(4), tau).mean(axis=1)
    if not np.isfinite(mean).all():
        return 0, np.inf
    exponents = np.linalg.eigvals(mean) * corners.period
    exponents = np.take_along_axis(exponents, np.argsort(-exponents.real, axis=1), axis=1)
    sizes = group_sizes(np.exp(exponents))
    if not sizes:
        return 0, np.inf
    d = sizes[0]
    phase = np.abs(exponents.imag[:, :d]).sum(axis=1)
    along_u, along_v = (
        _grid_over(first, float(np.abs(phase[list(one)] - phase[list(other)]).max()) / 2)
        for first, one, other in ((FIRST_DEGREES[0], (1, 3), (0, 2)), (FIRST_DEGREES[1], (2, 3), (0, 1)))
    )
    return d, along_u * along_v


def _grid_over(first: int, degree: float) -> int:
    """Nodes of a direction: its degree begins with ``first`` and is doubled."""
    return (first << max(0, int(np.ceil(np.log2((first + degree) / first))))) + 1


def _work_at(corners: GridPoints, d: int, tolerance: float, dearest: float) -> float:
    """Work at each corner of a box, its slowest and steepest among them; infinite from ``dearest`` steps on.

    A few points tell what hundreds would cost, before those are begun.
    """
    found = ConvergingMultipliers(corners, 1)
    known = settle(found, d, tolerance, HALVINGS * dearest * corners.count) and bool(found.steps.mean() <= dearest)
    return found.work / corners.count if known else np.inf


class _BoxRefinement:
    """A patch over one box, by refining its grid; ``split_u``: where to halve it if there is none."""

    def __init__(self, points: AtNodes, box: Box, tolerance: float, threads: int, most_work: float) -> None:
        self.points, self.box, self.tolerance, self.most_work = points, box, tolerance, most_work
        self.grid = Grid(box, *FIRST_DEGREES)
        self.found = ConvergingMultipliers(points(*self.grid.nodes()), threads)
        self.place = np.arange(len(self.found.steps))  # of each node of the grid among all points
        self.split_u = True

    def patch(self) -> Patch | None:
        """The patch, or None where it costs too much or would need too high a degree."""
        while self._roughly():
            sizes = group_sizes(self.found.fine)
            if not sizes:
                return None
            d = min(sizes, key=lambda size: float(self._tails(size)[2].max()))
            if not settle(self.found, d, self.tolerance, self.most_work):
                return None
            series, error, tails = self._tails(d)
            of_u, of_v = (tails > 1).tolist()
            if not (of_u or of_v):
                return series.patch(self.box, error) if d in group_sizes(self.found.fine) else None
            if (of_u and self.grid.along_u == HIGHEST_DEGREE) or (of_v and self.grid.along_v == HIGHEST_DEGREE):
                self.split_u = of_u and self.grid.along_u == HIGHEST_DEGREE
                return None
            if not self._refine(of_u, of_v):
                return None
        return None

    def _tails(self, d: int) -> tuple[ChebyshevSeries, Array, Array]:
        """The series of d multipliers, the errors of its samples, and its tails along u and v over what is allowed."""
        e, errors, _ = known(self.found, d)
        trace = self.found.trace[self.place]
        values = np.column_stack([e[self.place], trace])
        series = ChebyshevSeries.of(self.grid, values)
        error = np.append(errors.max(axis=0), 1e-12 * np.abs(trace).max())
        allowed = np.maximum(self.tolerance * np.maximum(np.abs(values).max(axis=0), 1.0), error)
        # The trace only tells whether a line is damped at all, so its own tail may be what it is.
        return series, error, np.array([(t / allowed)[:-1].max() for t in (series.tail_u, series.tail_v)])

    def _roughly(self) -> bool:
        """Sharpen points until all tell groups apart; False where that costs too much."""
        while len(rough := self.found.rough()):
            if self.found.work > self.most_work or self.found.steps[rough].max() >= MOST_STEPS:
                return False
            self.found.sharpen(rough)
        return True

    def _refine(self, of_u: bool, of_v: bool) -> bool:
        """Sample the grid of twice the degree; False where that would cost too much."""
        grid, old = self.grid.refined(of_u, of_v)
        fresh = int(np.count_nonzero(~old))
        if self.found.work * (1 + fresh / len(self.found.steps)) > self.most_work:
            return False
        u, v = grid.nodes()
        place = np.empty(len(u), dtype=np.intp)
        place[old] = self.place
        place[~old] = len(self.found.steps) + np.arange(fresh)
        self.found.add(self.points(u[~old], v[~old]))
        self.grid, self.place = grid, place
        return True


def _alike(patches: list[Patch]) -> list[Patch]:
    """Patches with as many coefficients each, an even number: a further multiplier 0 is never the largest."""
    most = max(len(p.error) - 1 for p in patches)
    most += most % 2

    def wider(part: Array) -> Array:
        absent = np.zeros((most + 1 - len(part), *part.shape[1:]))
        return np.concatenate([part[:-1], absent, part[-1:]])

    return [replace(p, coefficients=wider(p.coefficients), error=wider(p.error)) for p in patches]
