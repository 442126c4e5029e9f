"""Forces in bearings and joint centres, from the statics of all shafts of a train together.

Every shaft is a rigid bar on a fixed axis e. On it act the secondary couples of its forks, a force at each of
its joint centres, and its bearings. What holds it follows from the number of its bearings:

- two: radial forces (along u and v) in both, and one thrust along e;
- one: a radial force; the shaft passes thrust on to its neighbours (a centre bearing in rubber);
- none: it hangs between two joints with a sliding spline, which passes no thrust.

A joint between two shafts of two bearings each would carry force only where these are out of line; it is
taken to carry none. Forces and moments of every shaft vanish: 3 + 2 equations each (torsion is the business
of ``torques``), linear with constant coefficients, so one factorisation serves all angles.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.topology import LinkKind
from trunnion.errors import InputError
from trunnion.response.kinetostatics.bearings import Bearings, place_bearings
from trunnion.response.kinetostatics.chain import KinematicChain
from trunnion.response.kinetostatics.couples import Couples, turned
from trunnion.response.kinetostatics.frames import member_frames
from trunnion.results.fields import coordinate, internal, labelled, variable

ON_BEARING = "force of the shaft on its bearing"
ON_JOINT = "force of the shaft in front of the joint on the one behind it"


@labelled
class Supports:
    """Loads on bearings and joint centres.

    u and v are those of the joint in front of the shaft (on the first shaft: of the joint behind it at plane 0), of
    joint forces e, u, v those of the shaft behind.
    """

    names: tuple[str, ...] = coordinate("bearing")
    ratio: Array = internal("mean speed of the bearing's shaft over the input's", "1", "bearing")
    force: Array = variable("bearing standing input_angle", "N", ON_BEARING, name="support_force")
    joint_names: tuple[str, ...] = coordinate("loaded_joint")
    joint_force: Array = variable("loaded_joint axis input_angle", "N", ON_JOINT)
    idle: tuple[str, ...] = internal("joints taken to carry no force")


def support_forces(chain: KinematicChain, couples: Couples, bearings: Bearings) -> Supports:
    """Solve the statics of the train that the bearings belong to.

    Parameters
    ----------
    bearings : (shaft name, position, position) or (shaft name, position) each; positions [m] along the shaft
        from the joint in front of it, away from the drive; on the first shaft from the (first) joint behind it,
        so that they are negative.

    Raises
    ------
    InputError : bearings that cannot carry a couple, too many or too few of them, or a length not known.
    """
    placed = place_bearings(chain, bearings)
    train = {chain.members[m].train for m in placed}
    if len(train) != 1:
        raise InputError(
            "lie on both sides of a Ratio, whose gear forces are not described",
            key="supports",
            remedy="ask for the two sides one after the other",
        )
    members = [m for m, member in enumerate(chain.members) if member.train in train]
    statics = _Statics(chain, members, placed)
    return statics.solve(couples)


class _Statics:
    """The equations of one train: rows by member, columns by joint force and bearing force."""

    def __init__(self, chain: KinematicChain, members: list[int], placed: dict[int, tuple[float, ...]]) -> None:
        self.chain, self.members, self.placed = chain, members, placed
        self.frames = member_frames(chain)
        self.joints = [chain.members[m].joint for m in members if chain.members[m].joint >= 0]
        self.bearings = [(m, x) for m in members for x in placed.get(m, ())]
        self.thrusts = [m for m in members if len(placed.get(m, ())) == 2]
        self.idle = [j for j in self.joints if self._front(j) in self.thrusts and self._back(j) in self.thrusts]
        self.columns = 3 * len(self.joints) + 2 * len(self.bearings) + len(self.thrusts)
        self.scale = max([abs(x) for _, x in self.bearings] + [1e-3])
        self.rows: list[Array] = []
        self.owner: list[int] = []
        self.right: list[tuple[int, Array] | None] = []
        self._build()

    def _front(self, joint: int) -> int:
        return self.chain.steps[self.chain.steps[joint].parent].member

    def _back(self, joint: int) -> int:
        return self.chain.steps[joint].member

    def _place(self, joint: int) -> float:
        """Where a joint stands on the shaft in front of it [m], from where that shaft's positions count."""
        steps, front = self.chain.steps, self._front(joint)
        member = self.chain.members[front]
        own = self._shafts_before(joint)
        if member.joint < 0:
            first = next(j for j in self.joints if self._front(j) == front)
            apart = own.symmetric_difference(self._shafts_before(first))
            self._require_lengths(apart)
            return steps[steps[joint].parent].reach - steps[steps[first].parent].reach
        if np.isnan(member.length) or steps[steps[joint].parent].reach == 0:
            name = member.shafts[0] if member.shafts else steps[member.joint].name
            name = steps[min(own)].name if own else name
            yoke = name.endswith(", yoke")
            raise InputError(
                "is not known, but the support forces depend on it",
                element=name.removesuffix(", yoke"),
                key="yoke_length" if yoke else "length",
                remedy='write yoke_length = "80 mm", say' if yoke else f'pass lengths={{"{name}": 0.8}} [m]',
            )
        return steps[steps[joint].parent].reach

    def _shafts_before(self, joint: int) -> set[int]:
        """Shafts between a joint and the beginning of the member it hangs on."""
        steps, front = self.chain.steps, self._front(joint)
        return {
            i
            for i in self.chain.path(steps[joint].parent)
            if steps[i].link is LinkKind.SHAFT and steps[i].member == front
        }

    def _require_lengths(self, shafts: set[int]) -> None:
        steps = self.chain.steps
        for i in sorted(shafts):
            if steps[i].reach == steps[steps[i].parent].reach:
                raise InputError(
                    "is not known, but the support forces depend on it",
                    element=steps[i].name,
                    key="length",
                    remedy=f'pass lengths={{"{steps[i].name}": 0.8}} [m]',
                )

    def _build(self) -> None:
        for m in self.members:
            e, u, v = self.frames[m]
            force = np.zeros((3, self.columns))
            moment = np.zeros((3, self.columns))
            for k, j in enumerate(self.joints):
                columns = slice(3 * k, 3 * k + 3)
                if self._back(j) == m:
                    force[:, columns] += np.eye(3)
                if self._front(j) == m:
                    force[:, columns] -= np.eye(3)
                    moment[:, columns] -= self._place(j) * _cross_matrix(e)
            for b, (owner, x) in enumerate(self.bearings):
                if owner == m:
                    columns = slice(3 * len(self.joints) + 2 * b, 3 * len(self.joints) + 2 * b + 2)
                    force[:, columns] -= np.stack([u, v], axis=1)
                    moment[:, columns] -= x * np.stack([np.cross(e, u), np.cross(e, v)], axis=1)
            if m in self.thrusts:
                force[:, self.columns - len(self.thrusts) + self.thrusts.index(m)] -= e
            for row in force:
                self._add(row, m, None)
            for direction in (u, v):
                self._add(direction @ moment / self.scale, m, (m, direction))
            if not self.placed.get(m) and self.chain.members[m].joint >= 0:
                slip = np.zeros(self.columns)
                k = self.joints.index(self.chain.members[m].joint)
                slip[3 * k : 3 * k + 3] = e
                self._add(slip, m, None)
        for j in self.idle:
            k = self.joints.index(j)
            for axis in range(3):
                self._add(np.eye(self.columns)[3 * k + axis], self._back(j), None)

    def _add(self, row: Array, owner: int, right: tuple[int, Array] | None) -> None:
        self.rows.append(row)
        self.owner.append(owner)
        self.right.append(right)

    def solve(self, couples: Couples) -> Supports:
        matrix = np.array(self.rows)
        self._determinate(matrix)
        points = couples.standing.shape[-1]
        on_member = self._couples_in_space(couples, points)
        right = np.zeros((len(self.rows), points))
        for r, entry in enumerate(self.right):
            if entry is not None:
                right[r] = -(entry[1] @ on_member[entry[0]]) / self.scale
        solution = np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0], dtype=np.float64)
        n, b = 3 * len(self.joints), len(self.bearings)
        in_space = solution[:n].reshape(len(self.joints), 3, points)
        local = [self.frames[self._back(j)] @ f for j, f in zip(self.joints, in_space, strict=True)]
        steps = self.chain.steps
        return Supports(
            tuple(f"{self._shaft(m)} at {x:g} m" for m, x in self.bearings),
            np.array([float(self.chain.members[m].speed) for m, _ in self.bearings]),
            np.asarray(solution[n : n + 2 * b].reshape(b, 2, points), dtype=np.float64),
            tuple(steps[j].name for j in self.joints),
            np.asarray(np.reshape(local, (len(self.joints), 3, points)), dtype=float),
            tuple(steps[j].name for j in self.idle),
        )

    def _shaft(self, m: int) -> str:
        shafts = self.chain.members[m].shafts
        return shafts[0] if shafts else "shaft behind " + self.chain.steps[max(self.chain.members[m].joint, 0)].name

    def _couples_in_space(self, couples: Couples, points: int) -> Mapping[int, Array]:
        """Sum of the fork couples on each member, as vectors in space, shape (3, point)."""
        total = {m: np.zeros((3, points)) for m in self.members}
        joint_of_fork = [j for j in self.chain.joints for _ in range(2)]
        for f, m in enumerate(couples.member):
            if m in total:
                step = self.chain.steps[joint_of_fork[f]]
                # an input fork's u and v are turned by the joint's plane against those of its shaft
                local = turned(couples.standing[f], np.asarray(step.plane)) if f % 2 == 0 else couples.standing[f]
                total[m] += self.frames[m][1:].T @ local
        return total

    def _refuse_at_joint(self, loose: set[int]) -> None:
        """Blame a single bearing at a joint's centre, where it has no lever, rather than a neighbour it lets down."""
        for m in sorted(loose):
            if [abs(x) < 1e-9 for x in self.placed.get(m, ())] == [True]:
                raise InputError(
                    "lies at the centre of the joint that positions count from, where it cannot carry a couple",
                    element=self._shaft(m),
                    key="supports",
                    value=self.placed[m][0],
                    remedy="write its distance from that joint, or give the shaft two bearings",
                )

    def _determinate(self, matrix: Array) -> None:
        """Refuse lines that are not held, or held twice."""
        left, values, right = np.linalg.svd(matrix)
        rank = int(np.sum(values > 1e-9 * values[0]))
        if rank < len(self.rows):
            loose = np.abs(left[:, rank:]).sum(axis=1)
            self._refuse_at_joint({m for m, share in zip(self.owner, loose, strict=True) if share > 1e-9})
            m = self.owner[int(loose.argmax())]
            count = len(self.placed.get(m, ()))
            own = ("no bearing", "one bearing", "its bearings")[count]
            raise InputError(
                f"is not held: {own} and its neighbours cannot carry its couple",
                element=self._shaft(m),
                key="supports",
                remedy="give it two bearings, or give them to the shafts it hangs on",
            )
        if rank < self.columns:
            free = np.abs(right[rank:]).sum(axis=0)[3 * len(self.joints) :][: 2 * len(self.bearings)]
            m = self.bearings[int(free.argmax()) // 2][0] if len(free) else self.members[0]
            raise InputError(
                "is held by more bearings than statics can divide its load between",
                element=self._shaft(m),
                key="supports",
                remedy="leave out a bearing, or give every shaft two",
            )


def _cross_matrix(vector: Array) -> Array:
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
