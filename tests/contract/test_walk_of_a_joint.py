"""A joint is added as ``CONTRIBUTING.md`` walks through it, and every analysis that counts joints counts it."""

from __future__ import annotations

import pytest
from walks import Walk, shown

PATH = "src/trunnion/driveline/wobble.py"
RIGHT = """
import json
import numpy as np, xarray as xr, trunnion as tn
from trunnion.cli import app
from trunnion.driveline.features import UNEVEN
from trunnion.features import TABLE, Treatment
from typer.testing import CliRunner

line = tn.Driveline([
    tn.ConstantSpeed(), tn.Shaft(stiffness=9e3, damping=2.0, name="front"), tn.Disk(inertia=0.3, name="hub"),
    tn.Wobble(angle="20 deg", plane="10 deg"), tn.Shaft(stiffness=5e3, damping=2.0, name="rear"),
    tn.Disk(inertia=0.6, name="load"),
], operation=tn.Operation(speed="500 rpm", speed_range=("400 rpm", "600 rpm")))
tn.dump(line, "wobble.toml")
assert tn.load("wobble.toml") == line

# dψ/dχ of ψ = χ + A sin(2χ + 0.4) + A/5 sin(5χ − 1)
A, chi = 0.3 * np.deg2rad(20) ** 2, lambda turned: turned - np.deg2rad(10)
ratio = lambda turned: 1 + 2 * A * np.cos(2 * chi(turned) + 0.4) + A * np.cos(5 * chi(turned) - 1.0)
trunnion = lambda *words: CliRunner().invoke(app, words)
assert trunnion("kinetostatics", "wobble.toml", "-o", "turn.nc", "-o", "turn.png").exit_code == 0
turn = xr.open_dataset("turn.nc", engine="h5netcdf")
np.testing.assert_allclose(turn.speed.sel(shaft="rear"), tn.rpm(500) * ratio(turn.input_angle), rtol=1e-12)
found = json.loads(trunnion("order-response", "wobble.toml", "--speed", "500rpm", "--json", "-o", "orders.nc").stdout)
assert {2.0, 5.0} <= {one["order"] for one in found["orders"]}

# The torque of the rear shaft to first order in A, by hand: the joint prescribes the difference Δ of two rotations.
small = line.replace("Wobble 1", angle=1e-3)
w, a = tn.rpm(500), 0.3e-6
for order, size in ((2, a), (5, a / 5)):
    s = 1j * order * w
    front, rear, hub, load = 9e3 + 2 * s, 5e3 + 2 * s, 0.3 * s**2, 0.6 * s**2
    # hub x: (J₁s² + k₁) x + k₂(x + Δ − y) = 0, load y: J₂s² y = k₂(x + Δ − y)
    x, y = np.linalg.solve([[hub + front + rear, -rear], [-rear, load + rear]], [-rear * size, rear * size])
    expected = abs(rear * (x + size - y))
    response = tn.order_response(small, [w])
    there = response.torque[0, list(response.order).index(order), response.springs.index("rear")]
    np.testing.assert_allclose(abs(there), expected, rtol=1e-5)

assert "Wobble" in UNEVEN and TABLE["certify_stability"]["Wobble"].treatment is Treatment.COUNTED
proof = trunnion("certify-stability", "wobble.toml", "-t", "hub.inertia=1%", "--speed", "500rpm:600rpm")
assert "proved stable" in proof.stdout
assert tn.sketch(line) is not None
"""


@pytest.mark.slow
def test_a_joint_changes_at_most_five_files(tmp_path) -> None:
    walk = Walk(tmp_path / "copy")
    walk.add(PATH, shown(PATH))
    kinds, home = "src/trunnion/driveline/kinds.py", "from trunnion.driveline.wobble import Wobble"
    walk.put(kinds, "        Wobble,\n", before="        Ratio,\n")
    walk.put(kinds, f"{home}\n", after="import PiecewiseShaft\n")
    walk.put("src/trunnion/__init__.pyi", f"{home} as Wobble\n", before="from trunnion.equations.exact_oscillator")
    walk.put("tests/contract/joints.py", '    "Wobble": tn.Wobble(angle=0.5),\n', after="distance_ratio=1.4),\n")
    walk.put("CHANGELOG.md", "\n- `Wobble`.\n", after="### Added\n")
    walk.print_features()
    walk.check(RIGHT)
    walk.test("Wobble or wobble or page or field or public", "joints", "features", "source", "imports", "examples")
    assert len(walk.changed()) <= 5, walk.changed()
