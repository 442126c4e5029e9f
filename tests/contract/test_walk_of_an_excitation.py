"""An excitation is added as ``CONTRIBUTING.md`` walks through it, and found right by value in every analysis."""

from __future__ import annotations

import pytest
from walks import Walk, shown

MOST_CHANGED = 5
DESCRIPTION, NUMBERS, LAWS, FEATURES = (
    f"src/trunnion/{name}.py"
    for name in ("driveline/excitation", "driveline/parameters", "equations/amplitudes", "driveline/features")
)
ORACLE = "tests/oracles/harmonic_lines.py"


@pytest.mark.slow
def test_an_excitation_changes_at_most_five_files(tmp_path) -> None:
    walk = Walk(tmp_path / "copy")
    walk.put(DESCRIPTION, "    Damping,\n", after="    Angle,\n")
    walk.put(DESCRIPTION, '"viscous_amplitude", ', after='("amplitude", "quadratic_amplitude", ')
    walk.put(DESCRIPTION, shown(DESCRIPTION), after="over the square of the disk's speed, instead\"\n    )\n")
    line = "    viscous_amplitude : A over the disk's mean speed [N m s/rad].\n"
    walk.put(DESCRIPTION, line, after="[N m s²/rad²], as of oscillating masses.\n")
    walk.put(NUMBERS, shown(NUMBERS), after='"N*m*s^2/rad^2",\n')
    walk.put(LAWS, shown(LAWS), after="running.speed**2,\n")
    walk.put(FEATURES, '"Excitation.viscous_amplitude", ', after='"Excitation.quadratic_amplitude", ')
    walk.put(ORACLE, shown(ORACLE), after="4e-6 * speed**2 + 0j),\n")
    assert len(walk.changed()) <= MOST_CHANGED
    walk.test(
        "with_the_speed or field_belongs or test_every_analysis or page or public",
        "excitations",
        "features",
        "examples",
    )
