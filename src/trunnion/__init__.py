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
    from trunnion.analyses.assessment.assess import assess
    from trunnion.analyses.assessment.envelope import envelope
    from trunnion.analyses.assessment.remedies.remedies import remedies
    from trunnion.analyses.chaos.bifurcation_diagram import bifurcation_diagram
    from trunnion.analyses.chaos.certify_chaos import certify_chaos
    from trunnion.analyses.chaos.chaos_zero_one import zero_one_test
    from trunnion.analyses.chaos.lyapunov_map import lyapunov_map, lyapunov_sweep
    from trunnion.analyses.chaos.lyapunov_spectrum import lyapunov_spectrum
    from trunnion.analyses.chaos.poincare_map import poincare_map
    from trunnion.analyses.charts.stability_chart import load_chart, stability_chart
    from trunnion.analyses.comparison.compare import compare
    from trunnion.analyses.kinetostatics import (
        CrossFriction,
        assembly_sensitivity,
        check_limits,
        kinetostatics,
        phase_forks,
    )
    from trunnion.analyses.limits.stable_limit import stable_limit
    from trunnion.analyses.linear.bending import bending_speeds
    from trunnion.analyses.linear.campbell_diagram import campbell_diagram
    from trunnion.analyses.linear.natural_frequencies import natural_frequencies
    from trunnion.analyses.linear.resonance_speeds import resonance_speeds
    from trunnion.analyses.linear.speed_sweep import speed_sweep, sweep_speeds
    from trunnion.analyses.linear.stability import stability
    from trunnion.analyses.motion.exact_motion import exact_motion
    from trunnion.analyses.motion.linearity_check import linearity_check
    from trunnion.analyses.motion.order_map import order_map
    from trunnion.analyses.motion.run_up import run_up
    from trunnion.analyses.motion.safe_accelerations import safe_accelerations
    from trunnion.analyses.motion.simulate import simulate
    from trunnion.analyses.optimisation.optimise import optimise
    from trunnion.analyses.orbits.basins import basins
    from trunnion.analyses.orbits.frequency_response import compare_responses, frequency_response
    from trunnion.analyses.orbits.harmonic_balance import harmonic_balance
    from trunnion.analyses.orbits.harmonic_balance_springs import balance_springs
    from trunnion.analyses.orbits.periodic_branch import periodic_branch
    from trunnion.analyses.orbits.periodic_response import periodic_response
    from trunnion.analyses.orbits.piecewise_branch import piecewise_branch
    from trunnion.analyses.orbits.piecewise_orbit import piecewise_orbit
    from trunnion.analyses.orbits.piecewise_sweep import rattle_index, sweep
    from trunnion.analyses.orders.misfire import misfire
    from trunnion.analyses.orders.response import order_response
    from trunnion.analyses.perturbation.averaging import averaging
    from trunnion.analyses.perturbation.describing_function import DescribingFunction
    from trunnion.analyses.perturbation.multiple_scales import multiple_scales
    from trunnion.analyses.sensitivity.sensitivity import sensitivity
    from trunnion.analyses.tolerance.certify import certify_stability
    from trunnion.analyses.tolerance.study import tolerance_study
    from trunnion.analyses.tongues.tongues import tongues
    from trunnion.analyses.tongues.windows import minimum_damping, stable_windows
    from trunnion.driveline import (
        Clutch,
        ConstantSpeed,
        Coupling,
        Disk,
        DoubleCardanJoint,
        Driveline,
        Excitation,
        GearPair,
        HookeJoint,
        IdealJoint,
        Limit,
        LoadCase,
        Operation,
        PiecewiseShaft,
        Ratio,
        Ripple,
        RzeppaJoint,
        Schedule,
        Shaft,
        Slider,
        StiffnessVariation,
        Tolerance,
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
    from trunnion.driveline.cylinders import reciprocating_mass
    from trunnion.driveline.excitation_file import read_excitation
    from trunnion.driveline.layout import combined_angle, layout
    from trunnion.driveline.parameters import Parameter, Term, pack
    from trunnion.equations.exact_oscillator import exact_oscillator
    from trunnion.equations.speed_profile import SpeedProfile
    from trunnion.errors import ComputationError, InputError, InputRemark
    from trunnion.plots.layout import sketch
    from trunnion.reporting.report import report
    from trunnion.studies.entries import catalogue
    from trunnion.studies.reproduce import reproduce
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
    "RzeppaJoint": "trunnion.driveline",
    "Ripple": "trunnion.driveline",
    "DoubleCardanJoint": "trunnion.driveline",
    "Ratio": "trunnion.driveline",
    "GearPair": "trunnion.driveline",
    "TransmissionError": "trunnion.driveline",
    "StiffnessVariation": "trunnion.driveline",
    "Coupling": "trunnion.driveline",
    "PiecewiseShaft": "trunnion.driveline",
    "Clutch": "trunnion.driveline",
    "Slider": "trunnion.driveline",
    "Excitation": "trunnion.driveline",
    "Driveline": "trunnion.driveline",
    "Operation": "trunnion.driveline",
    "LoadCase": "trunnion.driveline",
    "Schedule": "trunnion.driveline",
    "Limit": "trunnion.driveline",
    "Tolerance": "trunnion.driveline",
    "load": "trunnion.driveline",
    "loads": "trunnion.driveline",
    "dump": "trunnion.driveline",
    "dumps": "trunnion.driveline",
    "layout": "trunnion.driveline.layout",
    "combined_angle": "trunnion.driveline.layout",
    "cardan_line": "trunnion.driveline.cardan_angles",
    "reciprocating_mass": "trunnion.driveline.cylinders",
    "read_excitation": "trunnion.driveline.excitation_file",
    "sketch": "trunnion.plots.layout",
    "catalogue": "trunnion.studies.entries",
    "deg": "trunnion.driveline",
    "rpm": "trunnion.driveline",
    "hz": "trunnion.driveline",
    # vary
    "Parameter": "trunnion.driveline.parameters",
    "Term": "trunnion.driveline.parameters",
    "pack": "trunnion.driveline.parameters",
    # analyse
    "assess": "trunnion.analyses.assessment.assess",
    "envelope": "trunnion.analyses.assessment.envelope",
    "remedies": "trunnion.analyses.assessment.remedies.remedies",
    "campbell_diagram": "trunnion.analyses.linear.campbell_diagram",
    "natural_frequencies": "trunnion.analyses.linear.natural_frequencies",
    "resonance_speeds": "trunnion.analyses.linear.resonance_speeds",
    "stability": "trunnion.analyses.linear.stability",
    "stability_chart": "trunnion.analyses.charts.stability_chart",
    "load_chart": "trunnion.analyses.charts.stability_chart",
    "stable_limit": "trunnion.analyses.limits.stable_limit",
    "compare": "trunnion.analyses.comparison.compare",
    "optimise": "trunnion.analyses.optimisation.optimise",
    "sensitivity": "trunnion.analyses.sensitivity.sensitivity",
    "tolerance_study": "trunnion.analyses.tolerance.study",
    "certify_stability": "trunnion.analyses.tolerance.certify",
    "tongues": "trunnion.analyses.tongues.tongues",
    "stable_windows": "trunnion.analyses.tongues.windows",
    "minimum_damping": "trunnion.analyses.tongues.windows",
    "speed_sweep": "trunnion.analyses.linear.speed_sweep",
    "sweep_speeds": "trunnion.analyses.linear.speed_sweep",
    "order_response": "trunnion.analyses.orders.response",
    "misfire": "trunnion.analyses.orders.misfire",
    "bending_speeds": "trunnion.analyses.linear.bending",
    "harmonic_balance": "trunnion.analyses.orbits.harmonic_balance",
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
    "simulate": "trunnion.analyses.motion.simulate",
    "SpeedProfile": "trunnion.equations.speed_profile",
    "periodic_response": "trunnion.analyses.orbits.periodic_response",
    "linearity_check": "trunnion.analyses.motion.linearity_check",
    "periodic_branch": "trunnion.analyses.orbits.periodic_branch",
    "run_up": "trunnion.analyses.motion.run_up",
    "safe_accelerations": "trunnion.analyses.motion.safe_accelerations",
    "order_map": "trunnion.analyses.motion.order_map",
    # chaos
    "lyapunov_spectrum": "trunnion.analyses.chaos.lyapunov_spectrum",
    "lyapunov_sweep": "trunnion.analyses.chaos.lyapunov_map",
    "lyapunov_map": "trunnion.analyses.chaos.lyapunov_map",
    "poincare_map": "trunnion.analyses.chaos.poincare_map",
    "bifurcation_diagram": "trunnion.analyses.chaos.bifurcation_diagram",
    "zero_one_test": "trunnion.analyses.chaos.chaos_zero_one",
    "certify_chaos": "trunnion.analyses.chaos.certify_chaos",
    # backlash
    "PiecewiseOscillator": "trunnion.systems.piecewise_oscillator",
    "SecondOrder": "trunnion.systems.second_order",
    "Spring": "trunnion.systems.second_order",
    "backlash_spring": "trunnion.systems.second_order",
    "cubic_spring": "trunnion.systems.second_order",
    "balance_springs": "trunnion.analyses.orbits.harmonic_balance_springs",
    "gear_pair": "trunnion.systems.gear_pair",
    "exact_motion": "trunnion.analyses.motion.exact_motion",
    "exact_oscillator": "trunnion.equations.exact_oscillator",
    "base_radius": "trunnion.systems.gear_pair",
    "frequency_response": "trunnion.analyses.orbits.frequency_response",
    "compare_responses": "trunnion.analyses.orbits.frequency_response",
    "piecewise_orbit": "trunnion.analyses.orbits.piecewise_orbit",
    "piecewise_branch": "trunnion.analyses.orbits.piecewise_branch",
    "sweep": "trunnion.analyses.orbits.piecewise_sweep",
    "basins": "trunnion.analyses.orbits.basins",
    "rattle_index": "trunnion.analyses.orbits.piecewise_sweep",
    "multiple_scales": "trunnion.analyses.perturbation.multiple_scales",
    "averaging": "trunnion.analyses.perturbation.averaging",
    "DescribingFunction": "trunnion.analyses.perturbation.describing_function",
    # hand on
    "report": "trunnion.reporting.report",
    "reproduce": "trunnion.studies.reproduce",
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
