"""An analysis is added as ``CONTRIBUTING.md`` walks through it, and found everywhere at once."""

from __future__ import annotations

import pytest
from walks import Walk, shown

NAME = "energy_share"
NEW = [f"src/trunnion/{room}/{NAME}.py" for room in ("response", "pictures", "cli")]
RIGHT = """
import json
import numpy as np, xarray as xr, trunnion as tn
from trunnion.cli import app
from typer.testing import CliRunner
from trunnion.features import TABLE, Treatment

line = tn.Driveline([
    tn.ConstantSpeed(), tn.Shaft(stiffness=900.0, name="front"), tn.Disk(inertia=0.5),
    tn.Shaft(stiffness=400.0, name="rear"), tn.Disk(inertia=0.3),
])
tn.dump(line, "line.toml")
# The two modes of M x'' + K x = 0 written out, each scaled to x' K x = 1.
mass, stiffness = np.diag([0.5, 0.3]), np.array([[1300.0, -400.0], [-400.0, 400.0]])
square, shape = np.linalg.eig(np.linalg.solve(mass, stiffness))
order = np.argsort(square)
shape = shape[:, order]
shape = shape / np.sqrt(np.einsum("ik,ij,jk->k", shape, stiffness, shape))
share = np.stack([900.0 * shape[0] ** 2, 400.0 * (shape[1] - shape[0]) ** 2], axis=1)

found = tn.energy_share(line)
np.testing.assert_allclose(found.share, share, rtol=1e-10)
np.testing.assert_allclose(found.frequency, np.sqrt(square[order]), rtol=1e-10)
assert found.springs == ("front", "rear") and found.data.share.dims == ("mode", "spring")
assert tn.energy_share(line, least=0.999).springs == ()
bars = [bar.get_height() for bar in found.plot().patches]
np.testing.assert_allclose(bars, share.T.ravel(), rtol=1e-10)
assert TABLE["energy_share"]["damping"].treatment is Treatment.INERT
assert TABLE["energy_share"]["stiffness"].treatment is Treatment.COUNTED

trunnion = lambda *words: CliRunner().invoke(app, words)
shown = json.loads(trunnion("energy-share", "line.toml", "--json", "-o", "x.nc", "-o", "x.png").stdout)
np.testing.assert_allclose(shown["share"], share, rtol=1e-10)
assert shown["command"] == "energy-share" and shown["written"] == ["x.nc", "x.png"]
np.testing.assert_allclose(xr.open_dataset("x.nc", engine="h5netcdf").share, share, rtol=1e-10)
assert open("x.png", "rb").read(4)[1:] == b"PNG"
assert trunnion("energy-share", "line.toml").stdout.splitlines()[1].startswith("  mode 1, ")
assert trunnion("energy-share", "line.toml", "--least", "2").exit_code == 2
assert "Share of every shaft in the elastic energy" in trunnion("--help").stdout
assert "Springs whose share stays below it are left out." in trunnion("energy-share", "--help").stdout
"""


@pytest.mark.slow
def test_an_analysis_changes_at_most_eight_files(tmp_path) -> None:
    walk = Walk(tmp_path / "copy")
    for path in NEW:
        walk.add(path, shown(path))
    registry, rows, questions = "src/trunnion/registry.py", "src/trunnion/features.py", "tests/contract/questions.py"
    walk.put(registry, shown(registry), before='    Analysis(\n        "speed_sweep",')
    walk.put(rows, shown(rows), before='    "linear motion": _row(')
    walk.put(questions, shown(questions), before='    "speed_sweep": Question(')
    home = f"from trunnion.response.{NAME} import {NAME} as {NAME}\n"
    walk.put("src/trunnion/__init__.pyi", home, before="from trunnion.response.kinetostatics import CrossFriction")
    row = "| Which shaft does a mode twist? | `energy-share` | [assess](assess.md) |\n"
    walk.put("docs/README.md", row, before="| How large is the vibratory torque")
    walk.put("CHANGELOG.md", "\n- `energy_share`: which shaft a mode twists.\n", after="### Added\n")
    noun = f"- **`{NAME}`**: Share of each spring in the elastic energy of each mode.\n"
    walk.put("docs/glossary.md", noun, before="- **`Engine`**")
    walk.print_features()
    walk.check(RIGHT)
    walk.test(
        f"{NAME} or EnergyShares or energy-share or page or row or asked or drawings or glossary or public",
        *("registry", "results", "signatures", "features", "speeds_in_text_and_pictures", "imports", "source", "help"),
        *("names", "examples"),
    )
    assert len(walk.changed()) <= 8, walk.changed()
