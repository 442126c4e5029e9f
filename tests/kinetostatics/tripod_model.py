"""A rigid tripod joint in space, solved angle by angle; nothing here is taken from the package.

The housing turns by φ about z and has three tracks parallel to z at radius R. The spider sits on a shaft
whose far end is fixed at a distance L from the spider's centre, in the direction that makes the bend β.
Each arm's line meets its track: three equations for the spider's centre (two of its coordinates; L gives
the third) and the spider's rotation. An ideal joint in line with the mean direction passes that rotation to
a standing shaft.
"""

import numpy as np
from scipy.optimize import least_squares

Z = np.array([0.0, 0.0, 1.0])


def shortest_turn(a, b):
    """Rotation matrix that takes direction a to b without turning about them."""
    k = np.cross(a, b)
    skew = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + skew + skew @ skew / (1 + a @ b)


def arms(angle):
    return np.array([[np.cos(angle + k), np.sin(angle + k), 0.0] for k in 2 * np.pi * np.arange(3) / 3])


class Tripod:
    def __init__(self, radius, length, bend):
        self.radius, self.length = radius, length
        self.mean = np.array([np.sin(bend), 0.0, np.cos(bend)])
        self.far = length * self.mean

    def spider(self, x, y):
        """Centre and axis of the spider from its centre's coordinates across the housing."""
        drop = np.sqrt(self.length**2 - (self.far[0] - x) ** 2 - (self.far[1] - y) ** 2)
        centre = np.array([x, y, self.far[2] - drop])
        return centre, (self.far - centre) / self.length

    def solve(self, phi):
        """Spider centre, spider axis, arm directions, and the rotation that arrives behind the far end."""
        tracks = self.radius * arms(phi)

        def miss(unknown):
            centre, axis = self.spider(self.radius * unknown[0], self.radius * unknown[1])
            directions = arms(unknown[2]) @ shortest_turn(Z, axis).T
            across = tracks - centre
            return (directions[:, 0] * across[:, 1] - directions[:, 1] * across[:, 0]) / self.radius

        found = least_squares(miss, [0.0, 0.0, phi], xtol=1e-15, ftol=1e-15, gtol=1e-15, method="lm").x
        centre, axis = self.spider(self.radius * found[0], self.radius * found[1])
        directions = arms(found[2]) @ shortest_turn(Z, axis).T
        arrived = shortest_turn(Z, self.mean).T @ shortest_turn(axis, self.mean) @ directions[0]
        turned = np.arctan2(arrived[1], arrived[0])
        return centre, axis, directions, phi + np.angle(np.exp(1j * (turned - phi)))

    def moment(self, phi):
        """Moment of the rollers on the spider about the housing's centre for unit torque on the housing.

        A roller passes a force square to its track and to its arm; the three forces add up to zero.
        """
        centre, _, directions, _ = self.solve(phi)
        tracks = self.radius * arms(phi)
        along = np.einsum("kj,kj->k", (tracks - centre)[:, :2], directions[:, :2])
        along /= np.einsum("kj,kj->k", directions[:, :2], directions[:, :2])
        places = centre + along[:, None] * directions
        forces = np.cross(Z, directions)
        forces /= np.linalg.norm(forces, axis=1)[:, None]
        moments = np.cross(places, forces)
        sizes = np.linalg.solve(np.stack([forces[:, 0], forces[:, 1], moments[:, 2]]), [0.0, 0.0, 1.0])
        return sizes @ moments
