"""An element is added as ``CONTRIBUTING.md`` walks through it, a spring that says its stiffness in its own numbers."""

from __future__ import annotations

import pytest
from walks import Walk, shown

PATH = "src/trunnion/driveline/torsion_spring.py"
RIGHT = """
import json
import numpy as np, xarray as xr, trunnion as tn
from trunnion.cli import app
from trunnion.driveline.features import feature
from typer.testing import CliRunner

def line(spring):
    return tn.Driveline([
        tn.ConstantSpeed(), spring, tn.Disk(inertia=0.02), tn.HookeJoint(angle="25 deg"),
        tn.Shaft(stiffness=400.0, damping=0.05), tn.Disk(inertia=0.01, load_torque=3.0),
    ], operation=tn.Operation(speed="40 rad/s", speed_range=("20 rad/s", "80 rad/s")))

coil = {"wire_diameter": "8 mm", "coil_diameter": "60 mm", "coils": 5.5, "modulus": "206 GPa"}
stiffness = 206e9 * 0.008**4 / (64 * 0.06 * 5.5)
coiled = line(tn.TorsionSpring(**coil, damping=0.03, fork_offset="30 deg", name="coil"))
plain = line(tn.Shaft(stiffness=stiffness, damping=0.03, fork_offset="30 deg", name="coil"))
tn.dump(coiled, "coil.toml")
assert tn.load("coil.toml") == coiled
assert feature("stiffness").places(coiled)[0] == "coil.wire_diameter"

trunnion = lambda *words: CliRunner().invoke(app, words)
# Modes of the straight line, written out.
square = np.sort(np.linalg.eigvals([[(stiffness + 400) / 0.02, -400 / 0.02], [-400 / 0.01, 400 / 0.01]]))
modes = json.loads(trunnion("natural-frequencies", "coil.toml", "--unit", "rad/s", "--json").stdout)["modes"]
np.testing.assert_allclose([one["undamped_frequency"] for one in modes], np.sqrt(square), rtol=1e-10)
# Every analysis has it as a shaft of that stiffness.
for ask in (
    lambda one: tn.stability(one).multipliers,
    lambda one: tn.order_response(one, [30.0, 60.0]).torque,
    lambda one: tn.periodic_response(one).torque,
    lambda one: tn.kinetostatics(one, rigid=False).data.twist,
):
    np.testing.assert_allclose(ask(coiled), ask(plain), rtol=1e-9, atol=1e-9)
# And its numbers are parameters: k ~ d**4.
words = ("stability-chart", "coil.toml", "--x", "speed:30rad/s:60rad/s:4", "--y", "coil.wire_diameter:7mm:9mm:3")
assert trunnion(*words, "-o", "x.nc", "-o", "x.png").exit_code == 0
radius = xr.open_dataset("x.nc", engine="h5netcdf").spectral_radius
there = tn.stability(plain.replace("coil", stiffness=stiffness * (9 / 8) ** 4), 60.0)
np.testing.assert_allclose(float(radius[-1, -1]), there.spectral_radius, atol=1e-8)
"""
REFUSED = """    (lambda: tn.TorsionSpring(wire_diameter=0.01), "TorsionSpring.coil_diameter: is needed", ""),
    (lambda: tn.TorsionSpring(stiffness=-4), "TorsionSpring.stiffness = -4: must be positive", ""),
"""


@pytest.mark.slow
def test_an_element_is_in_every_analysis(tmp_path) -> None:
    walk = Walk(tmp_path / "copy")
    walk.add(PATH, shown(PATH))
    kinds, home = "src/trunnion/driveline/kinds.py", "from trunnion.driveline.torsion_spring import TorsionSpring"
    walk.put(kinds, "        TorsionSpring,\n", before="        PiecewiseShaft,\n")
    walk.put(kinds, f"{home}\n", after="import PiecewiseShaft\n")
    walk.put("src/trunnion/__init__.pyi", f"{home} as TorsionSpring\n", before="from trunnion.equations.exact_osc")
    numbers = '    "wire_diameter": "m",\n    "coil_diameter": "m",\n    "coils": "1",\n    "modulus": "Pa",\n'
    walk.put("src/trunnion/driveline/packed_numbers.py", numbers, before='    "thickness": "m",\n')
    fields = '*_of_springs("wire_diameter", "coil_diameter", "coils", "modulus"),\n            '
    walk.put("src/trunnion/driveline/features.py", fields, before='*_of_springs("stiffness")')
    walk.put("tests/contract/test_bad_input.py", REFUSED, after="PYTHON = [\n")
    walk.put("CHANGELOG.md", "\n- `TorsionSpring`.\n", after="### Added\n")
    walk.check(RIGHT)
    walk.test(
        "TorsionSpring or field or page or torsion or public", "bad_input", "features", "source", "imports", "examples"
    )
    assert "docs/features.md" not in walk.changed()
