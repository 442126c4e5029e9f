"""An excitation is added to a copy of the package as ``CONTRIBUTING.md`` walks through it, and found right by value."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import trunnion

ROOT = Path(__file__).parents[2]
MOST_CHANGED = 5
WALK = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("**An excitation.**")[2].partition("\n**")[0]
NEW = (
    ("src/trunnion/driveline/excitation.py", "    Angle,\n", "    Damping,\n"),
    ("src/trunnion/driveline/excitation.py", '("amplitude", "quadratic_amplitude", ', '"viscous_amplitude", '),
    ("src/trunnion/driveline/excitation.py", "over the square of the disk's speed, instead\"\n    )\n", 0),
    ("src/trunnion/driveline/parameters.py", '"N*m*s^2/rad^2",\n', '        "viscous_amplitude": "N*m*s/rad",\n'),
    ("src/trunnion/equations/amplitudes.py", "running.speed**2,\n", 1),
    ("src/trunnion/driveline/features.py", '"Excitation.quadratic_amplitude", ', '"Excitation.viscous_amplitude", '),
    ("tests/oracles/harmonic_lines.py", "4e-6 * speed**2 + 0j),\n", 2),
)
"""Files, the words behind which something new stands, and what it is: the code that the walk shows, by its number, or
what it says in words."""


def shown() -> list[str]:
    """The pieces of code of the walk, as they stand in their files."""
    blocks = re.findall(r"```python\n(.*?)```", WALK, flags=re.DOTALL)
    return ["".join(f"{line[3:].rstrip()}\n" for line in block.splitlines() if line.strip()) for block in blocks]


def indented(code: str) -> str:
    return "".join(f"    {line}\n" for line in code.splitlines())


def test_an_excitation_changes_at_most_five_files(tmp_path: Path) -> None:
    shutil.copytree(Path(trunnion.__file__).parent, tmp_path / "src" / "trunnion")
    for folder in ("contract", "oracles"):
        shutil.copytree(ROOT / "tests" / folder, tmp_path / "tests" / folder)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    blocks = shown()
    for file, behind, new in NEW:
        place, text = tmp_path / file, indented(blocks[new]) if isinstance(new, int) else new
        content = place.read_text(encoding="utf-8")
        assert content.count(behind) == 1, f"{behind!r} in {file}"
        place.write_text(content.replace(behind, behind + text), encoding="utf-8")
    changed = {file for file, _, _ in NEW}
    assert changed == set(re.findall(r"^\d\. `([\w/.]+)`", WALK, flags=re.MULTILINE))
    assert len(changed) <= MOST_CHANGED
    tests = ("tests/contract/test_excitations.py", "tests/contract/test_features.py")
    of = "with_the_speed or test_every_field_belongs or test_every_analysis"
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-k", of, *tests], cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(tmp_path / "src")}, capture_output=True, text=True,
    )  # fmt: skip
    assert ran.returncode == 0, ran.stdout[-4000:]
    counted = re.search(r"(\d+) passed", ran.stdout)
    assert counted is not None and int(counted.group(1)) > 50, ran.stdout[-1000:]
