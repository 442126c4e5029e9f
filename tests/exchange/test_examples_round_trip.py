"""Every shipped example to the files of other programs and back: what such a file refuses by name is taken away, and
the frequencies of what is left are equal."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat
from scipy.linalg import eigh

import trunnion as tn
from trunnion.errors import InputError

EXAMPLES = {path.stem: path for path in sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))}
ENDINGS = {"csv": ".csv", "modelica": ".mo", "opentorsion": ".py", "matlab": ".mat"}
HELD = {
    "csv": {"pto-shaft", "rolling-mill-spindle", "rolling-mill-strip", "steering-column", "truck"},
    "modelica": {"pto-shaft", "rolling-mill-spindle", "rolling-mill-strip", "steering-column", "truck"},
    "matlab": {"pto-shaft", "rolling-mill-spindle", "rolling-mill-strip", "steering-column", "truck"},
    "opentorsion": set(),
}
"""Of whom enough is left: the others have an element that no such file holds, or, for openTorsion, a drive that holds
a rotation."""


def without(line: tn.Driveline, refused: InputError) -> tn.Driveline | None:
    """The line without the keys that a refusal names; None where it needs its elements changed."""
    changes: dict[str, dict[str, Any]] = {}
    for one in refused.problems:
        if one.element == "schedule" or one.key.startswith("schedule"):
            continue
        if one.element not in line.names or not one.key:
            return None
        usual = type(line.elements[line.names.index(one.element)]).model_fields[one.key]
        empty = 0.0 if one.key == "angle" else usual.get_default(call_default_factory=True)
        changes.setdefault(one.element, {})[one.key] = empty
    assert line.operation is not None
    line = line.model_copy(update={"operation": line.operation.model_copy(update={"schedules": ()})})
    try:
        return line.replace_all(changes)
    except InputError:
        return None


@pytest.mark.parametrize("name", EXAMPLES)
def test_frequencies_are_equal(name: str, tmp_path: Path) -> None:
    for to in ENDINGS:
        frequencies_are_equal(name, to, tmp_path)


def frequencies_are_equal(name: str, to: str, folder: Path) -> None:
    """Whether a file holds the example, and if so, as it is."""
    line, path = tn.load(EXAMPLES[name]), folder / f"line{ENDINGS[to]}"
    for _ in range(4):
        try:
            tn.export_line(line, path, to)
        except InputError as refused:
            assert not path.exists()
            assert all(one.remedy for one in refused.problems)
            left = without(line, refused)
            if left is None:
                assert name not in HELD[to], str(refused)
                return
            line = left
        else:
            break
    assert name in HELD[to] and path.exists()
    expected = tn.natural_frequencies(line).undamped_frequency
    if to == "opentorsion":
        assembly = runpy.run_path(str(path))["assembly"]
        found = np.sqrt(np.abs(eigh(assembly.K, assembly.M, eigvals_only=True)))
    elif to == "matlab":
        read = loadmat(path)
        found = np.sqrt(np.abs(eigh(read["stiffness"], read["M"], eigvals_only=True)))
    else:
        found = tn.natural_frequencies(tn.import_line(path)).undamped_frequency
    assert len(found) == len(expected)
    moving = expected > 1e-6 * expected.max()
    assert np.abs(found - expected)[moving].max() <= 1e-12 * expected.max()
    assert np.abs(found[~moving]).max(initial=0.0) <= 1e-6 * expected.max()
