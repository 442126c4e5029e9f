"""What descriptions accept is declared: mypy --strict reads tests/typed with the package in ``make check``."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TYPED = ROOT / "tests/typed"


def test_the_readme_is_among_what_is_read():
    code = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S)
    assert code
    assert (TYPED / "readme.py").read_text().split('"""', 2)[2].lstrip() == "\n".join(code)


def test_what_type_checkers_accept_is_accepted():
    subprocess.run([sys.executable, TYPED / "accepted.py"], check=True)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "told"),
    [
        ('tn.Disk(inertia=["0.4 kg*m^2"])', '"inertia" to "Disk" has incompatible type'),
        ('tn.HookeJoint(angle="20 deg", tilt=2)', 'Unexpected keyword argument "tilt" for "HookeJoint"'),
        ("tn.HookeJoint()", 'Missing named argument "angle" for "HookeJoint"'),
        ("tn.Shaft(stiffness=2).stiffness + 1", 'Unsupported operand types for + ("None" and "int")'),
    ],
)
def test_what_is_wrong_is_told_by_mypy(code, told, tmp_path):
    file = tmp_path / "wrong.py"
    file.write_text(f"import trunnion as tn\n\n{code}\n")
    ran = subprocess.run([sys.executable, "-m", "mypy", "--strict", file], capture_output=True, text=True, cwd=ROOT)
    assert told in ran.stdout
