"""Where the shafts of a line point: axes and planes in space from joint angles and planes.

Each member has a frame (e, u, v): e along its axis from the drive to the load, v = e × u. The first member
of a train points along x with u = −z (its first joint bends it downwards) and v = y. A joint with plane ϑ
turns u and v about e by ϑ and then bends e toward u by its angle β:

    u_j = cos ϑ u + sin ϑ v,   v_j = −sin ϑ u + cos ϑ v
    e′ = cos β e + sin β u_j,  u′ = −sin β e + cos β u_j,  v′ = v_j
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.response.kinetostatics.chain import KinematicChain

START = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def member_frames(chain: KinematicChain) -> Array:
    """Rows e, u, v of every member in space, shape (member, 3, 3); u and v of the joint in front of it."""
    frames = np.empty((len(chain.members), 3, 3))
    for m, member in enumerate(chain.members):
        if member.joint < 0:
            frames[m] = START
            continue
        step = chain.steps[member.joint]
        e, u, v = turned_about_axis(frames[chain.steps[step.parent].member], step.plane)
        c, s = np.cos(step.angle), np.sin(step.angle)
        frames[m] = c * e + s * u, -s * e + c * u, v
    return frames


def turned_about_axis(frame: Array, by: float) -> Array:
    """The frame (rows e, u, v) turned about e by an angle [rad]."""
    e, u, v = frame
    c, s = np.cos(by), np.sin(by)
    return np.stack([e, c * u + s * v, -s * u + c * v])
