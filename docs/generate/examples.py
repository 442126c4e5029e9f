"""A file with one element in it, for every kind: what ``trunnion.driveline.kinds`` gives as example, between neighbours."""

from __future__ import annotations

import re
import tomllib
import warnings
from functools import cache

import trunnion as tn
from trunnion.driveline.kinds import KINDS
from trunnion.pictures.driveline_sketch import draw

SHAFT = '[[element]]\ntype = "Shaft"\nstiffness = "12 kN*m/rad"\ndamping = "3 N*m*s/rad"\n'
DISK = '[[element]]\ntype = "Disk"\ninertia = "0.4 kg*m^2"\n'
LOAD = '[[element]]\ntype = "Disk"\nname = "load"\ninertia = "0.9 kg*m^2"\n'
DRIVE = '[[element]]\ntype = "ConstantSpeed"\n'
MORE = {"IdealJoint": 'angle = "12 deg"', "Differential": 'after = "hub"'}
"""Keys that make an example worth looking at."""
FIRST = ("ConstantSpeed", "Engine", "Motor")
LAST = ("Generator", "Fan", "Pump", "Propeller", "Vehicle")
SIDE = '[[element]]\ntype = "Disk"\nname = "right wheel"\nafter = "differential.right"\ninertia = "0.9 kg*m^2"\n'


def _keys(kind: str) -> str:
    """The keys of the example as lines of a file: what a message recommends, the first way where there are several."""
    text = str(getattr(KINDS[kind], "example", "")).split(", or ")[0].replace(" and ", ", ")
    parts = re.split(r", (?=\w+ = )(?![^{]*\})", text)  # not inside braces
    return "\n".join(part for part in parts if part) + "\n" if text else ""


def _element(kind: str) -> str:
    named = 'name = "differential"\n' if kind == "Differential" else ""
    more = f"{MORE[kind]}\n" if kind in MORE and "after" not in MORE[kind] else ""
    inertia = KINDS[kind].model_fields.get("inertia")
    heavy = 'inertia = "0.4 kg*m^2"\n' if inertia and inertia.is_required() else ""
    keys = _keys(kind)
    return f'[[element]]\ntype = "{kind}"\n{named}{heavy if "inertia" not in keys.split() else ""}{keys}{more}'


def _candidates(kind: str) -> list[list[str]]:
    """Neighbours to try, the likeliest first."""
    one = _element(kind)
    if kind in FIRST:
        return [[one, SHAFT, LOAD]]
    if kind in LAST:
        return [[DISK, SHAFT, one], [DRIVE, SHAFT, DISK, one]]
    if kind == "Differential":
        return [[DISK, SHAFT, DISK, one, LOAD, SIDE]]
    if kind == "Tyre":
        return [[DISK, SHAFT, DISK, one, _element("Vehicle")]]
    return [[DISK, one, LOAD], [DISK, SHAFT, DISK, one, SHAFT, LOAD], [DRIVE, DISK, one, SHAFT, LOAD]]


@cache
def example(kind: str) -> str:
    """The file, as it is read."""
    problems = []
    for parts in _candidates(kind):
        text = "format = 1\n\n" + "\n".join(parts)
        tomllib.loads(text)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", tn.InputRemark)
                draw(tn.loads(text))
        except tn.InputError as problem:
            problems.append(str(problem))
        else:
            return text
    raise ValueError(f"no file with a {kind}: {'; '.join(problems)}")
