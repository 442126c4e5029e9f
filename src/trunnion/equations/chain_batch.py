"""A line as the compiled chain kernel reads it: one program for its topology, one lane per case."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import LinkKind, Mesh, Topology, behind_joint
from trunnion.laws.fourier import FourierLaw
from trunnion.laws.hooke import CrossLaw
from trunnion.numerics.chain.chain_tables import ChainBatch, ChainProgram


class _ChainWalk:
    """Per station: which joint last changed its speed (and by what since), the same within its group, phase."""

    def __init__(self, topo: Topology, shift: Array, turned: Sequence[float]) -> None:
        """``turned`` [rad]: from the input to the output arm of every joint."""
        ratios = topo.ratio_values
        count = len(topo.stations)
        self.speed: list[tuple[int, float]] = [(-1, 1.0)] * count
        self.within: list[tuple[int, float]] = [(-1, 1.0)] * count
        self.phase = np.zeros((len(shift), count))
        self.joint_input: list[tuple[tuple[int, float], tuple[int, float]]] = []
        self.joint_phase: list[Array] = []
        for s, station in enumerate(topo.stations):
            b = station.before
            if station.link is LinkKind.ROOT:
                continue
            if station.link is LinkKind.SHAFT:
                self.speed[s] = self.speed[b]
                self.phase[:, s] = self.phase[:, b] + shift[:, s]
            elif station.link is LinkKind.JOINT:
                joint = len(self.joint_input)
                self.joint_input.append((self.speed[b], self.within[b]))
                self.joint_phase.append(self.phase[:, b] + shift[:, s])
                self.speed[s] = self.within[s] = (joint, 1.0)
                self.phase[:, s] = turned[joint]
            else:
                (j, rate), (g, factor) = self.speed[b], self.within[b]
                self.speed[s], self.within[s] = (j, rate / ratios[s]), (g, factor / ratios[s])
                self.phase[:, s] = self.phase[:, b] / ratios[s]


def chain_program(
    topo: Topology, coefficients: LineCoefficients, by_speed: frozenset[int] = frozenset()
) -> ChainProgram:
    """The topology as index arrays; see ``ChainProgram``.

    ``coefficients``: any of the line, for the form of its joints' laws. ``by_speed``: stations with loads that depend
    on the speed, as ``loaded_by_speed`` finds them.
    """
    walk = _ChainWalk(topo, np.zeros((1, len(topo.stations))), [0.0] * len(topo.joints))
    n = topo.size
    parent = np.full(n, -1, dtype=np.int64)
    near: list[tuple[int, float]] = [(-1, 0.0)] * n
    near_speed: list[tuple[int, float]] = [(-1, 0.0)] * n
    for compliance, (i, before) in zip(topo.compliances, topo.ends, strict=True):
        parent[i] = before
        near[i] = walk.within[compliance.near]
        near_speed[i] = walk.speed[topo.reference[topo.group_of(compliance.near)]]
    first, ripples = _ripples(topo, coefficients)
    members = _members(topo, by_speed)
    member_speed = [walk.speed[topo.reference[topo.group_of(s)]] for s in members]
    return ChainProgram(
        parent=parent,
        **_split("joint_speed_source joint_rate", [speed for speed, _ in walk.joint_input]),
        **_split("joint_ratio_source joint_ratio", [within for _, within in walk.joint_input]),
        **_split("near_source near_ratio", near),
        **_split("near_speed_source near_speed", near_speed),
        member_unknown=topo.unknown_of[members].astype(np.int64),
        **_split("member_source member_ratio", [walk.within[s] for s in members]),
        **_split("member_speed_source member_speed", member_speed),
        **_split(
            "wave_unknown wave_cycles",
            [(i, float(rate)) for i, mesh in _varying(topo) for rate in mesh.stiffness_rates],
        ),
        ripple_first=first,
        ripple_order=np.array([order for order, _ in ripples]),
        ripple_cycles=np.array([cycles for _, cycles in ripples]),
    )


def _ripples(topo: Topology, coefficients: LineCoefficients) -> tuple[Integers, list[tuple[float, float]]]:
    """Where the harmonics of every joint begin and the last end; of each its order and cycles per turn of the input."""
    first, ripples = [0], list[tuple[float, float]]()
    for station, law in zip(topo.joints, coefficients.joints, strict=True):
        if isinstance(law, FourierLaw):
            ripples += [(float(m), abs(m * float(topo.speed_ratio[station]))) for m in law.orders]
        first.append(len(ripples))
    return np.array(first, dtype=np.int64), ripples


def _varying(topo: Topology) -> list[tuple[int, Mesh]]:
    """The unknown behind each mesh whose stiffness varies, and the mesh."""
    return [(topo.ends[mesh.compliance][0], mesh) for mesh in topo.meshes if mesh.stiffness]


def loaded_by_speed(topo: Topology, coefficients: LineCoefficients) -> frozenset[int]:
    """Stations whose load depends on the speed in any case."""
    depends = np.any((coefficients.viscous != 0) | (coefficients.quadratic != 0), axis=0)
    return frozenset(s for s in range(len(topo.stations)) if depends[s])


def chain_batch(topo: Topology, coefficients: LineCoefficients, by_speed: frozenset[int] = frozenset()) -> ChainBatch:
    """The numbers of each case as a lane (lanes on the last axis), scaled as the kernel wants them."""
    co, n = coefficients, topo.size
    cases = len(co.speed)
    over_speed = 1 / co.speed
    inertia = topo.on_unknowns(co.inertia)
    stiffness, damping, torque = (np.zeros((cases, n)) for _ in range(3))
    scale, trace = np.ones((cases, n)), np.zeros(cases)
    for e, (i, p) in enumerate(topo.ends):
        stiffness[:, i] = co.stiffness[:, e] / inertia[:, i] * over_speed**2
        damping[:, i] = co.damping[:, e] / inertia[:, i] * over_speed
        trace += stiffness[:, i]
        if p >= 0:
            scale[:, i] = np.sqrt(inertia[:, i] / inertia[:, p])
            torque[:, i] = co.torque[:, e] / inertia[:, p] * over_speed**2
            trace += stiffness[:, i] * (scale[:, i] * topo.relative_ratios[topo.compliances[e].near]) ** 2
    members = _members(topo, by_speed)
    owner, sign = topo.unknown_of[members], np.sign(topo.mean_speeds[members])
    load = co.load - co.not_carried
    walk = _ChainWalk(topo, co.shift, [law.turned for law in co.joints])
    phase = np.stack(walk.joint_phase) if walk.joint_phase else np.zeros((0, cases))
    waves = [one for wave in co.waves for one in wave.harmonics]
    cosine = [law.cosine if isinstance(law, CrossLaw) else np.ones((cases, 1)) for law in co.joints]
    ripples = [law for law in co.joints if isinstance(law, FourierLaw)]
    sizes, phases = ([part for law in ripples for part in getattr(law, key)] for key in ("amplitude", "phase"))
    return ChainBatch(
        cosine=_rows(cosine, cases),
        phase=phase,
        stiffness=np.ascontiguousarray(stiffness.T),
        damping=np.ascontiguousarray(damping.T),
        scale=np.ascontiguousarray(scale.T),
        torque=np.ascontiguousarray(torque.T),
        member_inertia=np.ascontiguousarray((co.inertia[:, members] / inertia[:, owner]).T),
        member_load=np.ascontiguousarray((sign * load[:, members] / inertia[:, owner] * over_speed[:, None] ** 2).T),
        member_viscous=np.ascontiguousarray((co.viscous[:, members] / inertia[:, owner] * over_speed[:, None]).T),
        member_quadratic=np.ascontiguousarray((co.quadratic[:, members] / inertia[:, owner]).T),
        wave_share=np.reshape([one.amplitude for one in waves], (len(waves), cases)),
        wave_phase=np.reshape([one.phase for one in waves], (len(waves), cases)),
        # No lower bound: over speed ν is then exactly 1/Ω, and Z in these units stays analytic in every axis.
        ripple=_rows(sizes, cases),
        ripple_phase=_rows(phases, cases),
        frequency=np.sqrt(np.where(trace > 0, trace / n, 1.0)),
    )


def _rows(columns: Sequence[Array], cases: int) -> Array:
    """Numbers (case, 1) of each of several laws as rows (law, case)."""
    rows = [np.broadcast_to(column, (cases, 1))[:, 0] for column in columns]
    return np.stack(rows) if rows else np.zeros((0, cases))


def _members(topo: Topology, by_speed: frozenset[int]) -> list[int]:
    """Stations with inertia in groups whose inertia depends on the angle or that carry loads by speed, by unknown."""
    heavy = sorted({s for s, _, _ in topo.inertias})
    chosen = {topo.group_of(s) for s in heavy if s in by_speed or behind_joint(topo.stations, s)}
    members = [s for s in heavy if topo.group_of(s) in chosen and topo.unknown_of[s] >= 0]
    return sorted(members, key=lambda s: topo.unknown_of[s])


def _split(names: str, pairs: list[tuple[int, float]]) -> dict[str, Any]:
    """Sources and numbers of pairs, each under a name."""
    source, number = names.split()
    return {source: np.array([p[0] for p in pairs], dtype=np.int64), number: np.array([p[1] for p in pairs], float)}
