"""Lines of gears, differentials and planetary sets at random, and their equations with every shaft a coordinate of its
own, every contact of teeth a constraint and a multiplier for each."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from scipy.linalg import eigh, null_space

import trunnion as tn

FREQUENCY, TORQUE = 90.0, 7.0


@dataclass
class Model:
    """Moments of inertia by coordinate, springs (coordinate, coordinate, stiffness, damping), rows of constraints, and
    meshes (deflection by coordinate, stiffness, damping)."""

    inertia: list[float] = field(default_factory=list)
    springs: list[tuple[int, int, float, float]] = field(default_factory=list)
    ties: list[dict[int, float]] = field(default_factory=list)
    meshes: list[tuple[dict[int, float], float, float]] = field(default_factory=list)

    def shaft(self, inertia: float = 0.0) -> int:
        """A new coordinate."""
        self.inertia.append(inertia)
        return len(self.inertia) - 1

    @property
    def rules(self) -> np.ndarray:
        """G of G x = 0."""
        rules = np.zeros((len(self.ties), len(self.inertia)))
        for row, tie in zip(rules, self.ties, strict=True):
            row[list(tie)] = list(tie.values())
        return rules

    @property
    def matrices(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """M, C, K of the coordinates without their constraints."""
        n = len(self.inertia)
        damping, stiffness = np.zeros((2, n, n))
        for one, other, k, c in self.springs:
            row = np.zeros(n)
            row[one], row[other] = -1.0, 1.0
            stiffness, damping = stiffness + k * np.outer(row, row), damping + c * np.outer(row, row)
        for deflection, k, c in self.meshes:
            row = np.zeros(n)
            row[list(deflection)] = list(deflection.values())
            stiffness, damping = stiffness + k * np.outer(row, row), damping + c * np.outer(row, row)
        return np.diag(self.inertia), damping, stiffness

    def frequencies(self) -> np.ndarray:
        """Undamped [rad/s], ascending, on what the constraints leave free."""
        free = null_space(self.rules) if self.ties else np.eye(len(self.inertia))
        mass, _, stiffness = self.matrices
        squares = eigh(free.T @ stiffness @ free, free.T @ mass @ free, eigvals_only=True)
        return np.sqrt(np.maximum(squares, 0.0))

    def twists(self, at: int, torque: float, frequency: float) -> np.ndarray:
        """Amplitude of every spring's twist under a torque on a coordinate; the constraints by their multipliers."""
        mass, damping, stiffness = self.matrices
        rules, n = self.rules, len(self.inertia)
        dynamic = -(frequency**2) * mass + 1j * frequency * damping + stiffness
        whole = np.block([[dynamic, rules.T], [rules, np.zeros((len(rules), len(rules)))]])
        right = np.zeros(len(whole), dtype=complex)
        right[at] = torque
        x = np.linalg.solve(whole, right)[:n]
        return np.array([abs(x[other] - x[one]) for one, other, _, _ in self.springs])

    def eigenvalues(self) -> np.ndarray:
        """λ [1/s] of the damped equations on what the constraints leave free."""
        free = null_space(self.rules) if self.ties else np.eye(len(self.inertia))
        mass, damping, stiffness = (free.T @ part @ free for part in self.matrices)
        n = len(mass)
        low = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
        return np.linalg.eigvals(np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), low]))


class Drawn:
    """A line drawn at random, ``free`` or behind a ConstantSpeed, with its ``model``; the last disk is shaken."""

    def __init__(self, rng: np.random.Generator, parts: int, free: bool) -> None:
        self.rng, self.model, self.elements, self.loops = rng, Model(), list[object](), 0
        self.springs: list[str] = []
        start = self.model.shaft()
        self.speeds = {start: Fraction(1)}
        self.tips: list[tuple[str | None, int]] = []
        if free:
            self._disk("start", start, None, drive_share=1.0)
        else:
            self.elements.append(tn.ConstantSpeed(name="start"))
            self.model.ties.append({start: 1.0})
            self.tips = [("start", start)]
            self._spring(0)
        for number in range(1, parts):
            kind = rng.choice(["spring", "spring", "ratio", "held", "free", "elastic", "differential", "loop"])
            getattr(self, f"_{kind}")(number)
        self.shaken = self.tips[-1]

    @property
    def line(self) -> tn.Driveline:
        """As described."""
        line = tn.Driveline(self.elements)
        return line.replace(self.shaken[0], excitation=[{"frequency": FREQUENCY, "amplitude": TORQUE}])

    def _size(self, low: float, high: float) -> float:
        return float(np.exp(self.rng.uniform(np.log(low), np.log(high))))

    def _tip(self) -> tuple[str | None, int]:
        return self.tips[int(self.rng.integers(len(self.tips)))]

    def _disk(self, name: str, at: int, after: str | None, **more: float) -> None:
        inertia = self._size(0.01, 0.5)
        self.model.inertia[at] += inertia
        self.elements.append(tn.Disk(inertia=inertia, name=name, after=after, **more))
        self.tips.append((name, at))

    def _spring(self, number: int) -> None:
        after, near = self._tip()
        far, k, c = self.model.shaft(), self._size(1e3, 1e5), self._size(0.1, 5.0)
        self.speeds[far] = self.speeds[near]
        self.elements.append(tn.Shaft(stiffness=k, damping=c, name=f"shaft {number}", after=after))
        self.model.springs.append((near, far, k, c))
        self.springs.append(f"shaft {number}")
        self._disk(f"disk {number}", far, None)

    def _ratio(self, number: int) -> None:
        after, near = self._tip()
        out, ratio = self.model.shaft(), float(self.rng.choice([0.5, 2.0, 3.5, -1.5]))
        self.speeds[out] = self.speeds[near] / Fraction(str(ratio))
        self.elements.append(tn.Ratio(ratio=ratio, name=f"gears {number}", after=after))
        self.model.ties.append({near: 1.0, out: -ratio})
        self._disk(f"disk {number}", out, None)

    def _set(self, number: int, held: bool, elastic: bool = False) -> None:
        after, near = self._tip()
        sun, planet = int(self.rng.integers(18, 40)), int(self.rng.integers(15, 40))
        ring, spin, mass, distance = sun + 2 * planet, self._size(1e-4, 1e-2), self._size(0.1, 2.0), 0.1
        drives, driven, third = self.rng.permutation(["sun", "carrier", "ring"]).tolist()
        place = {drives: near, driven: self.model.shaft(), third: self.model.shaft()}
        planets = self.model.shaft(3 * spin)
        self.model.inertia[place["carrier"]] += 3 * mass * distance**2
        teeth = [
            {place["sun"]: sun, planets: planet, place["carrier"]: -(sun + planet)},
            {place["ring"]: ring, planets: -planet, place["carrier"]: -(ring - planet)},
        ]
        more: dict[str, float] = {}
        if elastic:
            # Deflections along the line of action, by base radii m z cos 20°/2; three planets.
            half, k, c = 0.002 * np.cos(np.pi / 9) / 2, [self._size(1e6, 1e8) for _ in teeth], self._size(10, 1e3)
            more = {"sun_mesh_stiffness": k[0], "ring_mesh_stiffness": k[1], "mesh_damping": c, "module": 0.002}
            self.model.meshes += [
                ({at: half * z for at, z in row.items()}, 3 * one, 3 * c) for row, one in zip(teeth, k, strict=True)
            ]
        else:
            self.model.ties += teeth
        name = f"set {number}"
        fixed = {"held": third} if held else {"output": driven}
        weight = {"sun": Fraction(sun), "ring": Fraction(ring), "carrier": Fraction(-sun - ring)}
        self.speeds[place[third]] = self.speeds[near] * (0 if held else 1)
        self.speeds[place[driven]] = self.speeds[near] * (-weight[drives] / weight[driven] if held else 1)
        self.elements.append(
            tn.Planetary(
                teeth_sun=sun,
                teeth_ring=ring,
                input=drives,
                planet_inertia=spin,
                planet_mass=mass,
                centre_distance=distance,
                name=name,
                after=after,
                **fixed,
                **more,
            )  # fmt: skip
        )
        self._disk(f"disk {number}", place[driven], None)
        if held:
            self.model.ties.append({place[third]: 1.0})
        else:
            self._disk(f"third {number}", place[third], f"{name}.{third}")

    def _loop(self, number: int) -> None:
        """A spring between any two disks that turn alike, on average."""
        pairs = [
            (a, b) for i, a in enumerate(self.tips) for b in self.tips[i + 1 :] if self._speed(a) == self._speed(b)
        ]
        if not pairs:
            return self._spring(number)
        (after, near), (to, far) = pairs[int(self.rng.integers(len(pairs)))]
        k, c = self._size(1e3, 1e5), self._size(0.1, 5.0)
        self.elements.append(tn.Shaft(stiffness=k, damping=c, name=f"shaft {number}", after=after, to=to))
        self.model.springs.append((near, far, k, c))
        self.springs.append(f"shaft {number}")
        self.loops += 1
        return None

    def _speed(self, tip: tuple[str | None, int]) -> Fraction:
        """Mean speed of a disk over the first one's."""
        return self.speeds[tip[1]]

    def _held(self, number: int) -> None:
        self._set(number, held=True)

    def _free(self, number: int) -> None:
        self._set(number, held=False)

    def _elastic(self, number: int) -> None:
        self._set(number, held=bool(self.rng.integers(2)), elastic=True)

    def _differential(self, number: int) -> None:
        after, near = self._tip()
        case, left, right = self.model.shaft(), self.model.shaft(), self.model.shaft()
        ratio, inertia, name = float(self.rng.choice([1.0, 3.0, -4.1])), self._size(0.01, 0.2), f"diff {number}"
        self.model.inertia[case] += inertia
        self.speeds |= dict.fromkeys((left, right), self.speeds[near] / Fraction(str(ratio)))
        self.model.ties += [{near: 1.0, case: -ratio}, {case: 2.0, left: -1.0, right: -1.0}]
        self.elements.append(tn.Differential(ratio=ratio, inertia=inertia, name=name, after=after))
        self._disk(f"left {number}", left, None)
        self._disk(f"right {number}", right, f"{name}.right")
