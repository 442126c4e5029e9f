"""Long lines are carried through in little memory, and as short ones are."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.numerics.chain import dense_monodromy


def long_line(disks: int) -> tn.Driveline:
    """A chain of disks with one joint near its front."""
    elements: list[object] = [tn.ConstantSpeed()]
    for i in range(disks):
        elements += [tn.Shaft(stiffness=1e4 * (1 + 0.1 * (i % 7)), damping=1.0), tn.Disk(inertia=0.1)]
        if i == 1:
            elements.append(tn.HookeJoint(angle=0.3))
    return tn.Driveline(elements)


def test_few_coefficients_at_a_time_and_all_at_once_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever fits into a chunk, and by compiled loops or by matrix products."""
    line = long_line(4)
    whole = tn.stability(line, 150.0)
    monkeypatch.setattr(dense_monodromy, "CHUNK", 1)
    monkeypatch.setattr(dense_monodromy, "SMALL", 0)
    parts = tn.stability(line, 150.0)
    assert np.allclose(parts.multipliers, whole.multipliers, rtol=0, atol=1e-12)
    assert whole.response is not None and parts.response is not None
    assert np.allclose(parts.response.torque, whole.response.torque, rtol=1e-9)
    assert parts.liouville_defect < 1e-11


@pytest.mark.slow
def test_memory_of_250_disks() -> None:
    """Less than 500 MB, imports included, measured in a process of its own; Liouville's identity holds."""
    import subprocess
    import sys

    program = (
        "import resource, sys; sys.path.insert(0, sys.argv[1])\n"
        "from test_long_lines import long_line\n"
        "import trunnion as tn\n"
        "found = tn.stability(long_line(250), 200.0)\n"
        "assert found.liouville_defect < 1e-9, found.liouville_defect\n"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)\n"
    )
    from pathlib import Path

    run = subprocess.run(
        [sys.executable, "-c", program, str(Path(__file__).parent)], capture_output=True, text=True, timeout=900
    )
    assert run.returncode == 0, run.stderr
    assert float(run.stdout) < 500
