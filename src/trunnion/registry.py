"""Every analysis in one place: what it answers, how it treats features, what draws, asks and shows it.

Everything stands here by address ("module:name"), so that the rooms of the package import downward and nothing is
loaded before it is needed. ``trunnion.features`` makes its table from this one; results find their pictures here, the
command line its commands and the application its views. Tests and pages are compared with it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any


@dataclass(frozen=True)
class Analysis:
    """One question that can be asked of a line or of a system.

    name : of the public function that answers it, ``trunnion.NAME``.
    sentence : what it answers, as ``trunnion --help`` says.
    features : the row of ``trunnion.features.ROWS`` that says how it treats each feature of a line; "" where it takes
        no line.
    pictures : what describes the pictures of its results, by class and method of the result or of what it is a kind of.
    command : the function of the command of the same name; "" without one.
    view : the view of the application, of ``VIEWS``, that shows it; "" where none does.
    """

    name: str
    sentence: str
    features: str = ""
    pictures: Mapping[str, str] = field(default_factory=dict)
    command: str = ""
    view: str = ""


ANALYSES = (
    Analysis(
        "assess",
        "Judge every limit of the file and every rule that applies, over its speed range; the binding one first.",
        features="judgement",
        command="trunnion.cli.assess:assess",
        view="verdict",
    ),
    Analysis(
        "campbell_diagram",
        "Modes of the loaded line over its speed range, what excites them, and where the two meet.",
        features="loaded modes",
        pictures={"CampbellDiagram.plot": "trunnion.pictures.campbell_diagram:campbell_diagram"},
        command="trunnion.cli.assess:campbell_diagram",
    ),
    Analysis(
        "envelope",
        "The worst of every check over all load cases and schedules of the file, and where it stands.",
        features="judgement",
        pictures={"Envelope.plot": "trunnion.pictures.design:envelope"},
        command="trunnion.cli.assess:envelope",
    ),
    Analysis(
        "stability",
        "Floquet stability at one speed, with the linear forced response.",
        features="linear motion",
        command="trunnion.cli.stability:stability",
        view="stability",
    ),
    Analysis(
        "stability_chart",
        "Stability over any two parameters, as picture and data.",
        features="multipliers",
        pictures={"StabilityChart.plot": "trunnion.pictures.stability_chart:stability_chart"},
        command="trunnion.cli.stability:stability_chart",
        view="stability",
    ),
    Analysis(
        "natural_frequencies",
        "Natural frequencies and damping ratios with all joints straight.",
        features="modes",
        pictures={"NaturalFrequencies.plot": "trunnion.pictures.modes:mode_shapes"},
        command="trunnion.cli.stability:natural_frequencies",
        view="driveline",
    ),
    Analysis(
        "damper_optimum",
        "The best damping, and stiffness, of a torsional vibration damper for one mode.",
        command="trunnion.cli.damper_optimum:damper_optimum",
        view="driveline",
    ),
    Analysis(
        "resonance_speeds",
        "Named parametric resonance speeds in the operating range, and at which of them instability can begin.",
        features="resonances",
        command="trunnion.cli.stability:resonance_speeds",
        view="stability",
    ),
    Analysis(
        "kinetostatics",
        "Motion, torques, secondary couples and support forces over a turn; fork phasing.",
        features="turn",
        pictures={"Kinetostatics.plot": "trunnion.pictures.kinetostatics:kinetostatics"},
        command="trunnion.cli.kinetostatics:kinetostatics",
        view="joints",
    ),
    Analysis(
        "phase_forks",
        "The fork offsets between joints for the least irregular output.",
        features="forks",
        view="joints",
    ),
    Analysis(
        "assembly_sensitivity",
        "Irregularity of the output under errors of joint angles, planes and fork offsets.",
        features="forks",
        view="limits",
    ),
    Analysis(
        "bending_speeds",
        "Critical bending speed of every shaft that is described as a tube.",
        features="whirl",
    ),
    Analysis(
        "order_response",
        "Vibratory torque of every shaft and mesh over speed, order by order, with stress, heat and speed fluctuation.",
        features="linear motion",
        pictures={
            "OrderResponse.plot": "trunnion.pictures.orders:order_response",
            "Misfire.plot": "trunnion.pictures.orders:misfire",
        },
        command="trunnion.cli.orders:order_response",
        view="orders",
    ),
    Analysis(
        "certify_peaks",
        "Prove how large torque and twist of every spring can be in a range of speeds and tolerances.",
        features="proof of peaks",
        pictures={"PeakCertificate.plot": "trunnion.pictures.design:peak_certificate"},
        command="trunnion.cli.limits:certify_peaks",
    ),
    Analysis(
        "coupling_temperatures",
        "Where the temperature of elastic couplings settles by the heat of their damping, if anywhere.",
        features="settled temperatures",
        pictures={"CouplingTemperatures.plot": "trunnion.pictures.coupling_temperatures:coupling_temperatures"},
        command="trunnion.cli.orders:coupling_temperatures",
    ),
    Analysis(
        "speed_sweep",
        "Torque and twist amplitude of every shaft over speed, all orders together; free–free lines included.",
        features="linear motion",
        pictures={"SpeedSweep.plot": "trunnion.pictures.orders:speed_sweep"},
        command="trunnion.cli.orders:speed_sweep",
    ),
    Analysis(
        "stable_limit",
        "The largest value of a parameter up to which the line is stable, over speed, and which limit binds before.",
        features="multipliers",
        pictures={"StableLimit.plot": "trunnion.pictures.stable_limit:stable_limit"},
        command="trunnion.cli.orders:stable_limit",
        view="limits",
    ),
    Analysis(
        "tongues",
        "Every instability region in a box of two parameters, as curves with resonance, tip and growth rate.",
        features="multipliers",
        pictures={"Tongues.plot": "trunnion.pictures.tongues:tongues"},
        command="trunnion.cli.limits:tongues",
        view="stability",
    ),
    Analysis(
        "stable_windows",
        "All ranges of a parameter, joint angles first, that keep a range of speeds stable.",
        features="multipliers",
        pictures={"StableWindows.plot": "trunnion.pictures.tongues:windows"},
        command="trunnion.cli.limits:stable_windows",
        view="limits",
    ),
    Analysis(
        "minimum_damping",
        "All ranges of damping that keep a range of speeds stable.",
        features="multipliers",
        command="trunnion.cli.limits:minimum_damping",
    ),
    Analysis(
        "compare",
        "What changed between two files, and what it did to frequencies, stability, torques and checks.",
        features="comparison",
        pictures={"Comparison.plot": "trunnion.pictures.design:comparison"},
        command="trunnion.cli.design:compare",
    ),
    Analysis(
        "optimise",
        "Choose numbers of the file within bounds, for one aim or for two, against its checks.",
        features="linear motion",
        pictures={"Optimum.plot": "trunnion.pictures.design:optimum"},
        command="trunnion.cli.design:optimise",
        view="limits",
    ),
    Analysis(
        "sensitivity",
        "Derivatives of frequencies, growth rates, torques and checks by the numbers of the file, ranked.",
        features="derivatives",
        pictures={"Sensitivities.plot": "trunnion.pictures.design:sensitivities"},
        command="trunnion.cli.design:sensitivity",
    ),
    Analysis(
        "certify_stability",
        "Prove that no line within its tolerances is unstable in a range of speeds, or find one that is.",
        features="proof",
        pictures={"StabilityCertificate.plot": "trunnion.pictures.design:certificate"},
        command="trunnion.cli.limits:certify_stability",
    ),
    Analysis(
        "tolerance_study",
        "The probability that the line is stable within its tolerances, its worst corner, and what matters.",
        features="multipliers",
        pictures={"ToleranceStudy.plot": "trunnion.pictures.design:tolerance"},
        command="trunnion.cli.limits:tolerance_study",
        view="limits",
    ),
    Analysis(
        "simulate",
        "A motion in time, of a driveline or of a reference system (duffing, lorenz, …).",
        features="motion",
        pictures={
            "SystemSimulation.plot": "trunnion.pictures.motion:history",
            "SystemSimulation.plot_portrait": "trunnion.pictures.motion:portrait",
            "LineSimulation.plot": "trunnion.pictures.motion:line_history",
            "LineSimulation.plot_order_map": "trunnion.pictures.motion:map_of_orders",
        },
        command="trunnion.cli.motion:simulate",
        view="stability",
    ),
    Analysis(
        "transient",
        "What happens when torques act over time, speed or angle: starts, blows, faults, brakes, from rest too.",
        features="transients",
        pictures={
            "Transient.plot": "trunnion.pictures.transients:history",
            "Transient.plot_plane": "trunnion.pictures.transients:plane",
            "Transient.plot_order_map": "trunnion.pictures.transients:orders",
        },
        command="trunnion.cli.transients:transient",
        view="motion",
    ),
    Analysis(
        "periodic_response",
        "The true periodic motion, its torques, orders and stability, beside what linear theory says.",
        features="periodic motion",
        pictures={
            "PeriodicResponse.plot": "trunnion.pictures.motion:period",
            "PeriodicResponse.plot_orders": "trunnion.pictures.motion:orders",
            "PeriodicOrbit.plot": "trunnion.pictures.motion:orbit",
        },
        command="trunnion.cli.motion:periodic_response",
        view="motion",
    ),
    Analysis(
        "linearity_check",
        "How far linear theory holds at a speed: order-response beside periodic-response, and what misleads it.",
        features="periodic motion",
        pictures={"LinearityCheck.plot": "trunnion.pictures.motion:linearity"},
        command="trunnion.cli.motion:linearity_check",
    ),
    Analysis(
        "run_up",
        "Passage through resonance at an acceleration that sets in smoothly, against the steady response.",
        features="passage",
        pictures={"RunUp.plot": "trunnion.pictures.motion:run_up"},
        command="trunnion.cli.motion:run_up",
        view="motion",
    ),
    Analysis(
        "fatigue",
        "Cycles, damage and life of every element with an S–N curve, over duty, starts and barred ranges passed.",
        features="linear motion",
        pictures={
            "FatigueLife.plot": "trunnion.pictures.fatigue:fatigue",
            "FatigueLife.plot_damage": "trunnion.pictures.fatigue:damage",
        },
        command="trunnion.cli.fatigue:fatigue",
        view="motion",
    ),
    Analysis(
        "passing",
        "Whether the line comes from one speed to another under its motor's torque, or is captured by a resonance.",
        pictures={"Passing.plot": "trunnion.pictures.transients:passing"},
        command="trunnion.cli.transients:passing",
        view="motion",
    ),
    Analysis(
        "least_drive",
        "The least factor of the drive torque with which a line passes its resonances.",
    ),
    Analysis(
        "least_acceleration",
        "The least acceleration with which a line passes its resonances.",
    ),
    Analysis(
        "capture_map_cost",
        "How long a map of captures will take, and how much it will hold.",
    ),
    Analysis(
        "capture_map",
        "From which share of its starting phases a line is captured by a resonance, over two parameters.",
        pictures={"CaptureMap.plot": "trunnion.pictures.transients:capture_map"},
        command="trunnion.cli.transients:capture_map",
    ),
    Analysis(
        "safe_accelerations",
        "The slowest and the fastest acceleration whose passage keeps a limit of torque.",
        features="passage",
    ),
    Analysis(
        "periodic_branch",
        "The periodic motion of a line or a forced system while a parameter moves.",
        features="branch",
        pictures={"PeriodicBranch.plot": "trunnion.pictures.frequency_response:branch"},
    ),
    Analysis(
        "harmonic_balance",
        "A periodic motion over a parameter by harmonic balance.",
        features="long motion",
    ),
    Analysis(
        "frequency_response",
        "Frequency response with folds, jumps and stability, by one method or several.",
        features="branch",
        pictures={"ResponseCurves.plot": "trunnion.pictures.frequency_response:response"},
        command="trunnion.cli.rattle:frequency_response",
        view="motion",
    ),
    Analysis("compare_responses", "The same frequency response by several methods."),
    Analysis(
        "sweep",
        "Settled motion step by step, up and down: swing, contact, impacts and rattle index, with jumps.",
        features="stages",
        pictures={
            "OscillatorSweep.plot": "trunnion.pictures.frequency_response:sweep",
            "LineSweep.plot": "trunnion.pictures.frequency_response:line_sweep",
        },
        command="trunnion.cli.rattle:sweep",
        view="motion",
    ),
    Analysis(
        "exact_motion",
        "The motion of a line whose springs are linear stage by stage, to rounding.",
        features="stages",
    ),
    Analysis(
        "piecewise_orbit",
        "The exact periodic motion of a line with stages, stable or not.",
        features="stages",
    ),
    Analysis(
        "piecewise_branch",
        "Exact periodic motions of a line with stages over a range of speeds.",
        features="branch by stages",
    ),
    Analysis(
        "basins",
        "Which settled motion every pair of position and velocity ends in.",
        pictures={"Basins.plot": "trunnion.pictures.frequency_response:basins"},
    ),
    Analysis(
        "lyapunov_spectrum",
        "Lyapunov exponents with intervals of confidence, and the sum rule.",
        features="long motion",
        pictures={"LyapunovSpectrum.plot": "trunnion.pictures.chaos:convergence"},
        command="trunnion.cli.chaos:lyapunov_spectrum",
        view="motion",
    ),
    Analysis(
        "lyapunov_sweep",
        "Lyapunov exponents at every value of one parameter.",
        features="long motion",
        pictures={"LyapunovSweep.plot": "trunnion.pictures.chaos:lyapunov_sweep"},
    ),
    Analysis(
        "lyapunov_map",
        "The largest Lyapunov exponent over two parameters.",
        features="long motion",
        pictures={"LyapunovMap.plot": "trunnion.pictures.chaos:lyapunov_map"},
    ),
    Analysis(
        "poincare_map",
        "Points of a settled motion, once per forcing period or on a section.",
        features="long motion",
        pictures={"PoincareMap.plot": "trunnion.pictures.chaos:poincare_map"},
        command="trunnion.cli.chaos:poincare_map",
        view="motion",
    ),
    Analysis(
        "bifurcation_diagram",
        "Points of the Poincaré map over one parameter.",
        features="long motion",
        pictures={"BifurcationDiagram.plot": "trunnion.pictures.chaos:bifurcations"},
    ),
    Analysis(
        "measure",
        "The signals that pickups and gauges on a test bench would record of a line, with what spoils them.",
        features="linear motion",
    ),
    Analysis(
        "track_orders",
        "Amplitude and phase of orders over speed from measured pulses and signals, with their uncertainty.",
        pictures={
            "MeasuredOrders.plot": "trunnion.pictures.measured:orders",
            "MeasuredOrderMap.plot": "trunnion.pictures.measured:order_map",
        },
        command="trunnion.cli.measured:track_orders",
    ),
    Analysis(
        "compare_measured",
        "Measured orders over what the line predicts, with a sentence on what differs.",
        features="measured orders",
        pictures={
            "MeasuredComparison.plot": "trunnion.pictures.measured:comparison",
            "MeasuredComparison.plot_campbell": "trunnion.pictures.measured:on_campbell",
            "MeasuredComparison.plot_run_up": "trunnion.pictures.measured:on_run_up",
        },
        command="trunnion.cli.measured:compare_measured",
        view="measured",
    ),
    Analysis(
        "identify",
        "Angles, stiffness, damping, inertia or excitation that explain measured orders, with intervals and rivals.",
        features="fitted orders",
        pictures={"Identification.plot": "trunnion.pictures.measured:identification"},
        command="trunnion.cli.measured:identify",
    ),
    Analysis(
        "study",
        "One analysis at very many points of a line, on all cores or a cluster, every answer kept.",
        pictures={
            "Study.plot": "trunnion.pictures.studies:study",
            "SobolIndices.plot": "trunnion.pictures.studies:shares",
            "StudyBoundary.plot": "trunnion.pictures.boundaries:boundary",
        },
    ),
    Analysis(
        "certify_chaos",
        "Regular, chaotic, unbounded or undecided, with reasons and one figure.",
        features="long motion",
        pictures={"ChaosCertificate.plot": "trunnion.pictures.chaos:certificate"},
        command="trunnion.cli.chaos:certify_chaos",
        view="motion",
    ),
)
"""In the order in which help and tables list them."""
PICTURES: Mapping[str, str] = {key: address for one in ANALYSES for key, address in one.pictures.items()}
"""What describes the picture of a result: ``Class.method`` → address."""
LIVE: Mapping[str, str] = {
    "Driveline": "trunnion.animation.notebook:of_line",
    "Animation": "trunnion.animation.notebook:shown",
    "NaturalFrequencies": "trunnion.animation.notebook:of_modes",
    "PeriodicResponse": "trunnion.animation.notebook:of_motion",
    "RunUp": "trunnion.animation.notebook:of_run",
    "Transient": "trunnion.animation.notebook:of_transient",
}
"""What a notebook shows in motion of a class, beside its words; see ``trunnion.live``."""

VIEWS: Mapping[str, str] = {
    "dashboard": "trunnion.app.views.dashboard:DashboardView",
    "driveline": "trunnion.app.views.driveline:DrivelineView",
    "live": "trunnion.app.views.live:LiveView",
    "parts": "trunnion.app.views.parts:PartsView",
    "verdict": "trunnion.app.views.verdict:VerdictView",
    "orders": "trunnion.app.views.orders:OrdersView",
    "stability": "trunnion.app.views.stability:StabilityView",
    "joints": "trunnion.app.views.joints:JointsView",
    "limits": "trunnion.app.views.limits:LimitsView",
    "motion": "trunnion.app.views.motion:MotionView",
    "measured": "trunnion.app.views.measured:MeasuredView",
    "studies": "trunnion.app.views.studies:StudiesView",
}
"""The views of the application, in the order of its page."""


def found_at(address: str) -> Any:
    """What stands at "module:name"."""
    module, name = address.split(":")
    return getattr(import_module(module), name)
