"""Trunnion: parametric stability and torsional vibration of jointed drivelines.

    import trunnion as tn
    line = tn.load("truck.toml")
    print(tn.stability(line, speed=tn.rpm(1500)))

Names are imported when first used, so that ``trunnion --help`` and ``import trunnion`` stay light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from trunnion._version import __version__

if TYPE_CHECKING:
    from trunnion.analyses.bending import bending_speeds
    from trunnion.analyses.kinetostatics import (
        CrossFriction,
        assembly_sensitivity,
        check_limits,
        kinetostatics,
        phase_forks,
    )
    from trunnion.analyses.natural_frequencies import natural_frequencies
    from trunnion.analyses.resonance_speeds import resonance_speeds
    from trunnion.analyses.speed_sweep import speed_sweep, sweep_speeds
    from trunnion.analyses.stability import stability
    from trunnion.analyses.stability_chart import load_chart, stability_chart
    from trunnion.analyses.stable_limit import stable_limit
    from trunnion.driveline import (
        ConstantSpeed,
        Disk,
        DoubleCardanJoint,
        Driveline,
        HookeJoint,
        IdealJoint,
        LoadCase,
        Operation,
        Ratio,
        Shaft,
        TripodJoint,
        deg,
        dump,
        dumps,
        hz,
        load,
        loads,
        rpm,
    )
    from trunnion.driveline.cardan_angles import cardan_line
    from trunnion.driveline.layout import combined_angle, layout
    from trunnion.driveline.parameters import Parameter, Term, pack
    from trunnion.errors import ComputationError, InputError, InputRemark
    from trunnion.plots.layout import sketch
    from trunnion.published import catalogue
    from trunnion.reporting import report
    from trunnion.reproduction import reproduce
    from trunnion.systems.family import PeriodicLinearFamily
    from trunnion.systems.periodic_linear import PeriodicLinearSystem

_HOME = {
    # describe
    "ConstantSpeed": "trunnion.driveline",
    "Shaft": "trunnion.driveline",
    "Disk": "trunnion.driveline",
    "HookeJoint": "trunnion.driveline",
    "IdealJoint": "trunnion.driveline",
    "TripodJoint": "trunnion.driveline",
    "DoubleCardanJoint": "trunnion.driveline",
    "Ratio": "trunnion.driveline",
    "Driveline": "trunnion.driveline",
    "Operation": "trunnion.driveline",
    "LoadCase": "trunnion.driveline",
    "load": "trunnion.driveline",
    "loads": "trunnion.driveline",
    "dump": "trunnion.driveline",
    "dumps": "trunnion.driveline",
    "layout": "trunnion.driveline.layout",
    "combined_angle": "trunnion.driveline.layout",
    "cardan_line": "trunnion.driveline.cardan_angles",
    "sketch": "trunnion.plots.layout",
    "catalogue": "trunnion.published",
    "deg": "trunnion.driveline",
    "rpm": "trunnion.driveline",
    "hz": "trunnion.driveline",
    # vary
    "Parameter": "trunnion.driveline.parameters",
    "Term": "trunnion.driveline.parameters",
    "pack": "trunnion.driveline.parameters",
    # analyse
    "natural_frequencies": "trunnion.analyses.natural_frequencies",
    "resonance_speeds": "trunnion.analyses.resonance_speeds",
    "stability": "trunnion.analyses.stability",
    "stability_chart": "trunnion.analyses.stability_chart",
    "load_chart": "trunnion.analyses.stability_chart",
    "stable_limit": "trunnion.analyses.stable_limit",
    "speed_sweep": "trunnion.analyses.speed_sweep",
    "sweep_speeds": "trunnion.analyses.speed_sweep",
    "bending_speeds": "trunnion.analyses.bending",
    "kinetostatics": "trunnion.analyses.kinetostatics",
    "CrossFriction": "trunnion.analyses.kinetostatics",
    "check_limits": "trunnion.analyses.kinetostatics",
    "phase_forks": "trunnion.analyses.kinetostatics",
    "assembly_sensitivity": "trunnion.analyses.kinetostatics",
    "PeriodicLinearSystem": "trunnion.systems.periodic_linear",
    "PeriodicLinearFamily": "trunnion.systems.family",
    # hand on
    "report": "trunnion.reporting",
    "reproduce": "trunnion.reproduction",
    # errors
    "InputError": "trunnion.errors",
    "InputRemark": "trunnion.errors",
    "ComputationError": "trunnion.errors",
}

__all__ = ["__version__", *_HOME]


def __getattr__(name: str) -> Any:
    try:
        home = _HOME[name]
    except KeyError:
        raise AttributeError(f"trunnion has no {name!r}") from None
    value = getattr(import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
