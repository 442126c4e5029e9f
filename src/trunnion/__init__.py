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
    from trunnion.analyses.averaging import averaging
    from trunnion.analyses.bending import bending_speeds
    from trunnion.analyses.bifurcation_diagram import bifurcation_diagram
    from trunnion.analyses.certify_chaos import certify_chaos
    from trunnion.analyses.chaos_zero_one import zero_one_test
    from trunnion.analyses.describing_function import DescribingFunction
    from trunnion.analyses.exact_motion import exact_motion
    from trunnion.analyses.frequency_response import compare_responses, frequency_response
    from trunnion.analyses.harmonic_balance import harmonic_balance
    from trunnion.analyses.harmonic_balance_springs import balance_springs
    from trunnion.analyses.kinetostatics import (
        CrossFriction,
        assembly_sensitivity,
        check_limits,
        kinetostatics,
        phase_forks,
    )
    from trunnion.analyses.lyapunov_map import lyapunov_map, lyapunov_sweep
    from trunnion.analyses.lyapunov_spectrum import lyapunov_spectrum
    from trunnion.analyses.multiple_scales import multiple_scales
    from trunnion.analyses.natural_frequencies import natural_frequencies
    from trunnion.analyses.order_map import order_map
    from trunnion.analyses.periodic_branch import periodic_branch
    from trunnion.analyses.periodic_response import periodic_response
    from trunnion.analyses.piecewise_branch import piecewise_branch
    from trunnion.analyses.piecewise_orbit import piecewise_orbit
    from trunnion.analyses.piecewise_sweep import basins, rattle_index, sweep
    from trunnion.analyses.poincare_map import poincare_map
    from trunnion.analyses.resonance_speeds import resonance_speeds
    from trunnion.analyses.run_up import run_up, safe_accelerations
    from trunnion.analyses.simulate import simulate
    from trunnion.analyses.speed_sweep import speed_sweep, sweep_speeds
    from trunnion.analyses.stability import stability
    from trunnion.analyses.stability_chart import load_chart, stability_chart
    from trunnion.analyses.stable_limit import stable_limit
    from trunnion.driveline import (
        ConstantSpeed,
        Disk,
        DoubleCardanJoint,
        Driveline,
        Excitation,
        GearPair,
        HookeJoint,
        IdealJoint,
        LoadCase,
        Operation,
        PiecewiseShaft,
        Ratio,
        Shaft,
        StiffnessVariation,
        TransmissionError,
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
    from trunnion.equations.exact_oscillator import exact_oscillator
    from trunnion.equations.speed_profile import SpeedProfile
    from trunnion.errors import ComputationError, InputError, InputRemark
    from trunnion.plots.layout import sketch
    from trunnion.published import catalogue
    from trunnion.reporting import report
    from trunnion.reproduction import reproduce
    from trunnion.systems.events import Event
    from trunnion.systems.family import PeriodicLinearFamily
    from trunnion.systems.gear_pair import base_radius, gear_pair
    from trunnion.systems.maps import SectionMap, StroboscopicMap
    from trunnion.systems.periodic_linear import PeriodicLinearSystem
    from trunnion.systems.piecewise_oscillator import PiecewiseOscillator
    from trunnion.systems.reference import reference_system
    from trunnion.systems.regimes import Regimes, Switch
    from trunnion.systems.second_order import SecondOrder, Spring, backlash_spring, cubic_spring
    from trunnion.systems.system import System

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
    "GearPair": "trunnion.driveline",
    "TransmissionError": "trunnion.driveline",
    "StiffnessVariation": "trunnion.driveline",
    "PiecewiseShaft": "trunnion.driveline",
    "Excitation": "trunnion.driveline",
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
    "harmonic_balance": "trunnion.analyses.harmonic_balance",
    "kinetostatics": "trunnion.analyses.kinetostatics",
    "CrossFriction": "trunnion.analyses.kinetostatics",
    "check_limits": "trunnion.analyses.kinetostatics",
    "phase_forks": "trunnion.analyses.kinetostatics",
    "assembly_sensitivity": "trunnion.analyses.kinetostatics",
    "PeriodicLinearSystem": "trunnion.systems.periodic_linear",
    "PeriodicLinearFamily": "trunnion.systems.family",
    # nonlinear motion
    "System": "trunnion.systems.system",
    "Regimes": "trunnion.systems.regimes",
    "Switch": "trunnion.systems.regimes",
    "Event": "trunnion.systems.events",
    "reference_system": "trunnion.systems.reference",
    "StroboscopicMap": "trunnion.systems.maps",
    "SectionMap": "trunnion.systems.maps",
    "simulate": "trunnion.analyses.simulate",
    "SpeedProfile": "trunnion.equations.speed_profile",
    "periodic_response": "trunnion.analyses.periodic_response",
    "periodic_branch": "trunnion.analyses.periodic_branch",
    "run_up": "trunnion.analyses.run_up",
    "safe_accelerations": "trunnion.analyses.run_up",
    "order_map": "trunnion.analyses.order_map",
    # chaos
    "lyapunov_spectrum": "trunnion.analyses.lyapunov_spectrum",
    "lyapunov_sweep": "trunnion.analyses.lyapunov_map",
    "lyapunov_map": "trunnion.analyses.lyapunov_map",
    "poincare_map": "trunnion.analyses.poincare_map",
    "bifurcation_diagram": "trunnion.analyses.bifurcation_diagram",
    "zero_one_test": "trunnion.analyses.chaos_zero_one",
    "certify_chaos": "trunnion.analyses.certify_chaos",
    # backlash
    "PiecewiseOscillator": "trunnion.systems.piecewise_oscillator",
    "SecondOrder": "trunnion.systems.second_order",
    "Spring": "trunnion.systems.second_order",
    "backlash_spring": "trunnion.systems.second_order",
    "cubic_spring": "trunnion.systems.second_order",
    "balance_springs": "trunnion.analyses.harmonic_balance_springs",
    "gear_pair": "trunnion.systems.gear_pair",
    "exact_motion": "trunnion.analyses.exact_motion",
    "exact_oscillator": "trunnion.equations.exact_oscillator",
    "base_radius": "trunnion.systems.gear_pair",
    "frequency_response": "trunnion.analyses.frequency_response",
    "compare_responses": "trunnion.analyses.frequency_response",
    "piecewise_orbit": "trunnion.analyses.piecewise_orbit",
    "piecewise_branch": "trunnion.analyses.piecewise_branch",
    "sweep": "trunnion.analyses.piecewise_sweep",
    "basins": "trunnion.analyses.piecewise_sweep",
    "rattle_index": "trunnion.analyses.piecewise_sweep",
    "multiple_scales": "trunnion.analyses.multiple_scales",
    "averaging": "trunnion.analyses.averaging",
    "DescribingFunction": "trunnion.analyses.describing_function",
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
