"""Excitation by the reciprocating masses of an engine or compressor."""

from __future__ import annotations

from math import pi

from trunnion.driveline.excitation import Excitation
from trunnion.driveline.quantities import LENGTH, MASS, parse
from trunnion.errors import InputError

MOST_ORDERS = 24


def reciprocating_mass(
    mass: float | str, crank_radius: float | str, rod_length: float | str, orders: int = 6
) -> tuple[tuple[Excitation, ...], float]:
    """Inertia torque of one cylinder's reciprocating mass by order, and the mean inertia it adds to its throw.

    Parameters
    ----------
    mass : piston, pin and the rod's oscillating part [kg].
    crank_radius, rod_length : r and l between the centres [m].
    orders : of the turning of the crank to give, from 1; zero rotation is the top dead centre.

    Returns
    -------
    Excitations for a ``Disk``, growing with the square of its speed, and about ½ m r² [kg m²] to add to its inertia.
    Coefficients are those of the exact mechanism.

    Raises
    ------
    InputError : sizes that are not positive, a rod not longer than the crank, orders out of range.

    Examples
    --------
    >>> import trunnion as tn
    >>> masses, inertia = tn.reciprocating_mass("1.2 kg", "45 mm", "150 mm", orders=3)
    >>> [round(one.quadratic_amplitude / (1.2 * 0.045**2), 4) for one in masses], round(inertia, 6)
    ([0.0768, -0.5003, -0.233], 0.001244)
    """
    m, r, length = parse(mass, MASS), parse(crank_radius, LENGTH), parse(rod_length, LENGTH)
    for key, value in (("mass", m), ("crank_radius", r)):
        if not value > 0:
            raise InputError("must be positive", key=key, value=value, remedy='write "1.2 kg" or "45 mm", say')
    if not length > r:
        raise InputError("must be longer than the crank", key="rod_length", value=length, remedy='write "150 mm", say')
    if not 1 <= orders <= MOST_ORDERS:
        raise InputError(f"must be from 1 to {MOST_ORDERS}", key="orders", value=orders, remedy="orders=6, say")
    from trunnion.laws.slider_crank import inertia_harmonics

    harmonics, mean = inertia_harmonics(r / length, orders)
    # b sin nθ = b cos(nθ − 90°)
    found = tuple(
        Excitation(order=n, quadratic_amplitude=float(b) * m * r**2, phase=-pi / 2)
        for n, b in enumerate(harmonics, start=1)
    )
    return found, mean * m * r**2
