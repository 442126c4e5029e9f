"""The true periodic motion of a loaded line at its operating speed, case by case, for the report."""

from __future__ import annotations

from dataclasses import dataclass

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Rotor
from trunnion.driveline.operating_speed import known_speed
from trunnion.errors import ComputationError, InputError
from trunnion.motion.orbits.periodic_response import PeriodicResponse, periodic_response
from trunnion.results.finding import Finding, Gravity
from trunnion.waiting import OutOfTime

AS_DESCRIBED = "as described"


@dataclass(frozen=True)
class LoadedMotion:
    """One case: its name and the periodic response."""

    case: str
    response: PeriodicResponse


def loaded_motions(line: Driveline, speed: float | None) -> tuple[tuple[LoadedMotion, ...], tuple[str, ...]]:
    """The line as described, if it carries a load, and every load case; and what was left out, in sentences."""
    operation = line.operation
    speed = speed if speed is not None else known_speed(line)
    if speed is None:
        return (), ()
    cases = {AS_DESCRIBED: line} if _loaded(line) else {}
    cases |= {case.name: line.with_load(case.name) for case in (operation.load_cases if operation else ())}
    found: list[LoadedMotion] = []
    without: dict[str, list[str]] = {}  # why, and the cases of which that is said
    for name, loaded in cases.items():
        try:
            response = periodic_response(loaded, speed)
        except (InputError, ComputationError) as error:
            without.setdefault(str(error), []).append(name)
            continue
        except OutOfTime as error:
            without.setdefault(f"not computed, {error.why}", []).append(name)
            continue
        assert isinstance(response, PeriodicResponse)
        if response.outcome.ok:
            found.append(LoadedMotion(name, response))
        else:
            without.setdefault(str(response.outcome), []).append(name)
    left_out = (f"Motion under load ({', '.join(names)}): {why}" for why, names in without.items())
    return tuple(found), tuple(left_out)


def load_findings(motions: tuple[LoadedMotion, ...], unit: str) -> list[Finding]:
    """What the true motions say beyond linear theory, gravest of each case first."""
    found = []
    for motion in motions:
        for finding in motion.response.findings_in(unit):
            if finding.gravity is not Gravity.NOTE:
                found.append(Finding(finding.gravity, f"Under load ({motion.case}): {finding.sentence}"))
    return found


def heaviest(motions: tuple[LoadedMotion, ...]) -> LoadedMotion:
    """The case with the largest torque swing."""
    return max(motions, key=lambda m: float(m.response.torque_peak_to_peak.max()))


def _loaded(line: Driveline) -> bool:
    rotors = [e for e in line.elements if isinstance(e, Rotor)]
    return any(one.loaded_by_speed or one.excitation or getattr(one, "load_torque", 0.0) for one in rotors)
