"""A line as a Python script that builds an assembly of openTorsion, and read back without running it.

openTorsion joins gears by R_parent θ_parent + R_child θ_child = 0: shafts count their rotation in opposite senses, as
the shafts of two gears that mesh turn. Behind a positive ratio both count here each in its own sense, which is the
same; frequencies do not depend on it.
"""

from __future__ import annotations

import ast
import math
from fractions import Fraction
from typing import Any

from trunnion.errors import InputError
from trunnion.exchange.network import (
    FlangeDrive,
    FlangeGear,
    FlangeInertia,
    FlangeSpring,
    Network,
    bare_flange,
    loop_closed,
)

_LISTS = {"DISKS": 3, "SHAFTS": 5, "GEARS": 5}
"""Lists of the script, and how many values a row has."""
_SCRIPT = '''"""An assembly of openTorsion, written by Trunnion: J [kg m^2], k [N m/rad], c [N m s/rad]."""

import opentorsion as ot

NAME = {name}
# name, node, J
DISKS = [
{disks}]
# name, left node, right node, k, c
SHAFTS = [
{shafts}]
# name, node of the parent, node of the child, and their radii, of which only the quotient counts
GEARS = [
{gears}]

PARENTS = {{node: ot.Gear(node, 0.0, 1.0) for _, node, _, _, _ in GEARS}}
assembly = ot.Assembly(
    [ot.Shaft(left, right, k=k, c=c) for _, left, right, k, c in SHAFTS],
    disk_elements=[ot.Disk(node, I=inertia) for _, node, inertia in DISKS],
    gear_elements=[
        *PARENTS.values(),
        *(ot.Gear(child, 0.0, over / under, parent=PARENTS[parent]) for _, parent, child, under, over in GEARS),
    ]
    or None,
)

if __name__ == "__main__":
    frequencies, _, damping_ratios = assembly.modal_analysis()
    for frequency, ratio in zip(frequencies[::2], damping_ratios[::2]):
        print(f"{{frequency:.6g}} rad/s, damping ratio {{ratio:.4g}}")
'''


def script_of(network: Network) -> str:
    """The script.

    Raises
    ------
    InputError : a drive, a load, a bare node, a loop with gears: openTorsion has none of these.
    """
    _refuse(network)
    return _SCRIPT.format(
        name=ascii(network.name),
        disks=_rows((one.name, one.at, one.inertia) for one in network.of(FlangeInertia)),
        shafts=_rows((one.name, one.near, one.far, one.stiffness, one.damping) for one in network.of(FlangeSpring)),
        gears=_rows(
            (one.name, one.near, one.far, one.ratio.denominator, one.ratio.numerator) for one in network.of(FlangeGear)
        ),
    )


def _rows(rows: Any) -> str:
    return "".join(f"    ({', '.join(map(ascii, row))}),\n" for row in rows)


def _refuse(network: Network) -> None:
    other = "export it to csv, matlab or modelica"
    for drive in network.of(FlangeDrive):
        remedy = f"describe the drive by a Disk with its inertia, or {other}"
        raise InputError("holds a rotation, which openTorsion does not", element=drive.name, remedy=remedy)
    for one in network.of(FlangeInertia):
        for key in ("load_torque", "viscous_load"):
            if value := getattr(one, key):
                problem = "is a load, which an assembly of openTorsion does not have"
                raise InputError(problem, element=one.name, key=key, value=value, remedy=f"leave it out, or {other}")
    if (name := bare_flange(network)) is not None:
        remedy = "put a Disk there, or join springs in series into one"
        raise InputError("ends where nothing is heavy, which openTorsion does not solve", element=name, remedy=remedy)
    if network.of(FlangeGear) and (name := loop_closed(network)) is not None:
        remedy = f"open the loop, or {other}"
        raise InputError(
            "closes a loop of a line with gears, which openTorsion does not hold", element=name, remedy=remedy
        )
    if not network.of(FlangeSpring):
        raise InputError("has no spring", element=network.name or "line", remedy="give it a Shaft")


def read_script(text: str, source: str) -> Network:
    """The network that a script states, which is read and not run.

    Raises
    ------
    InputError : it is no such script.
    """
    stated = _stated(text, source)
    found = Network(stated["NAME"])
    found.items += [FlangeInertia(name, at, _number(inertia, name, source)) for name, at, inertia in stated["DISKS"]]
    for name, near, far, k, c in stated["SHAFTS"]:
        found.items.append(FlangeSpring(name, near, far, _number(k, name, source), _number(c, name, source)))
    for name, near, far, under, over in stated["GEARS"]:
        under, over = (Fraction(_number(one, name, source)) for one in (under, over))
        if not under or not over:
            raise _unlike(source, f"the radii of {name}")
        found.items.append(FlangeGear(name, near, far, over / under))
    return found


def _stated(text: str, source: str) -> dict[str, Any]:
    """NAME and the lists of a script."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise _unlike(source, "Python") from None
    found: dict[str, Any] = {"NAME": ""}
    for node in tree.body:
        if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
            key = node.targets[0].id
            if key in _LISTS or key == "NAME":
                try:
                    found[key] = ast.literal_eval(node.value)
                except (ValueError, TypeError, RecursionError, MemoryError):
                    raise _unlike(source, key) from None
    for key, length in _LISTS.items():
        rows = found.get(key)
        if not isinstance(rows, list) or not all(_is_row(row, length, 1 if key == "DISKS" else 2) for row in rows):
            raise _unlike(source, key)
    if not isinstance(found["NAME"], str):
        raise _unlike(source, "NAME")
    return found


def _is_row(row: object, length: int, nodes: int) -> bool:
    if not isinstance(row, tuple) or len(row) != length or not isinstance(row[0], str):
        return False
    return all(type(one) is int and one >= 0 for one in row[1 : 1 + nodes])


def _number(value: object, name: str, source: str) -> float | int:
    if type(value) in (int, float) and math.isfinite(value):  # type: ignore[arg-type]
        return value  # type: ignore[return-value]
    raise _unlike(source, f"the numbers of {name}")


def _unlike(source: str, what: str) -> InputError:
    remedy = "write it with trunnion export FILE --to opentorsion"
    return InputError(f"is not a script that Trunnion wrote: {what} cannot be read", key=source, remedy=remedy)
