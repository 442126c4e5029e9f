"""What all tests share: the order of files, which slow tests are studies, and fixtures of more than one file."""

from __future__ import annotations

import gc
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path

import pytest
import typer.testing
from typer.testing import CliRunner, Result

import trunnion as tn
from trunnion.cli import app
from trunnion.floquet.charts import cost_model
from trunnion.papers.shared.result import Reproduction

pytest_plugins = ["served", "skips", "thorough"]  # fixtures of the browser; what may be skipped; what takes long

STUDIES = {
    "test_captured_run_ups.py": "300 run-ups against a stiff integrator",
    "test_command_lines.py": "500 random command lines",
    "test_extremes_and_spectra.py": "50 gear lines against their exact motion",
    "test_features.py": "every feature crossed with every analysis, the costly ones too",
    "test_killed.py": "100 kills of workers, scheduler and client over one study",
    "test_killed_and_full.py": "14 commands killed at 30 moments and on disks of 10 sizes",
    "test_long_lines.py": "250 disks",
    "test_responses_of_long_lines.py": "200 long trees",
    "test_stability_of_long_lines.py": "200 long trees",
    "test_mutated_files.py": "20 000 mutated files",
    "test_phase_axes.py": "500 points on each of 20 charts",
    "test_resonance_names.py": "2000 unstable points",
}
"""Files whose slow tests are studies, and what they go through."""


LONGEST = [
    *("test_features.py", "test_integration.py", "test_in_the_browser.py", "test_examples.py"),
    *("test_boundaries.py", "test_hostile_names.py", "test_report.py", "test_applications.py", "test_pool.py"),
    *("test_charts_hold_their_word.py", "test_live_page.py", "test_stable_limit.py"),
    *("test_stability_charts.py", "test_exported_code.py", "test_speeds_in_text_and_pictures.py"),
    *("test_process.py", "test_views.py", "test_periods_and_verdicts.py", "test_variants.py"),
    *("test_transients_in_the_app.py", "test_dashboard.py", "test_whose_result.py", "test_server.py"),
    *("test_captured_run_ups.py", "test_submission.py", "test_charts_about_steady_states.py"),
    *("test_every_command.py", "test_sensitivity.py", "test_tolerance_study.py", "test_workers.py"),
    *("test_largest_values.py",),
]
"""Files that take longest, the longest first. The first two need different kernels, so that none is compiled twice."""

LINE = """\
format = 1
name = "test line"

[operation]
speed = "1500 rpm"
speed_range = ["600 rpm", "2400 rpm"]
angle_range = ["0 deg", "20 deg"]

[[operation.load_case]]
name = "climb"
loads = { "Disk 2" = "250 N*m" }

[[element]]
type = "ConstantSpeed"

[[element]]
type = "Shaft"
stiffness = "12 kN*m/rad"
damping = "3 N*m*s/rad"

[[element]]
type = "Disk"
inertia = "0.4 kg*m^2"

[[element]]
type = "HookeJoint"
angle = "12 deg"

[[element]]
type = "Shaft"
stiffness = "10 kN*m/rad"
damping = "3 N*m*s/rad"

[[element]]
type = "Disk"
inertia = "0.9 kg*m^2"
"""
Run = Callable[..., Result]

# A tree of so many commands takes a tenth of a second to build: once a process, as for its users, not once a call.
typer.testing._get_command = cache(typer.testing._get_command)


# Whatever is imported and compiled lives to the end: going through it now and then took a tenth of all the time.
gc.set_threshold(100_000, 50, 100)


def pytest_collection_finish() -> None:
    gc.collect()
    gc.freeze()


def pytest_xdist_auto_num_workers() -> int:
    """One more than processors: tests of the browser mostly wait, others for a kernel that is being compiled."""
    return (os.cpu_count() or 1) + 1


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.get_closest_marker("slow") and item.path.name in STUDIES:
            item.add_marker("study")
        if item.get_closest_marker("study"):
            item.add_marker("slow")  # so that "not slow" leaves it out
    # Two workers take whole files in this order; a long one taken last would be waited for by the other worker.
    items.sort(key=lambda item: LONGEST.index(item.path.name) if item.path.name in LONGEST else len(LONGEST))


@pytest.fixture(autouse=True, scope="session")
def compiling_pays():
    """Charts take the kernels, compiled already or not: which way is tested does not depend on what ran before."""
    patch = pytest.MonkeyPatch()
    patch.setattr(cost_model, "COMPILING", -1.0)
    yield
    patch.undo()


@pytest.fixture(scope="session")
def study() -> Callable[[str], Reproduction]:
    """``study(name)``, at the points of the documentation; each is computed once for all tests of a run."""
    return cache(lambda name: tn.reproduce(name))


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of its own with ``line.toml``, as the working folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    (tmp_path / "line.toml").write_text(LINE, encoding="utf-8")
    return tmp_path


@pytest.fixture
def run(here: Path) -> Run:
    """The command in this process; what it prints has "N m" as its unit, but where it gives a file's own text."""

    def invoked(*args: object) -> Result:
        words = [str(arg) for arg in args]
        result = CliRunner().invoke(app, words)
        if result.exit_code == 0 and words[:1] and words[0] not in PRINT_FILES:
            starred = [text for text in said(result, "--json" in words) if STAR.search(QUOTED.sub("", text))]
            assert not starred, starred
        return result

    return invoked


PRINT_FILES = ("catalogue", "components", "import", "schema")
STAR = re.compile(r"\b[kM]?N\*m|kg\*m\^2|rad/s\^2")
QUOTED = re.compile(r"\"(\\.|[^\"\\])*\"|'[^'\n]*'")
"""Texts of the file, which remarks quote; errors say what to write in it."""


def said(result: Result, as_json: bool) -> Iterator[str]:
    """Keys and texts of JSON, units as files have them aside; otherwise all that is printed."""
    with suppress(ValueError):  # older versions of click mix it into the other
        yield result.stderr
    if not (as_json and result.stdout.startswith("{")):
        yield result.stdout
        return
    waiting = [json.loads(result.stdout)]
    while waiting:
        one = waiting.pop()
        if isinstance(one, dict):
            yield from one
            waiting += [value for key, value in one.items() if not key.endswith(("unit", "units", "toml"))]
        elif isinstance(one, list):
            waiting += one
        elif isinstance(one, str):
            yield one


@pytest.fixture
def start(here: Path) -> Callable[..., subprocess.Popen[str]]:
    """Python in a process of its own, by default the command; importing the package under test."""

    def started(*args: str, program: tuple[str, ...] = ("-m", "trunnion.cli"), encoding: str = "utf-8"):
        source = str(Path(tn.__file__).parents[1])
        return subprocess.Popen(
            [sys.executable, *program, *args],
            cwd=here,
            env={**os.environ, "PYTHONPATH": source, "PYTHONIOENCODING": encoding},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            # Where the tests run in the background, or on without a terminal, signals are ignored; this is inherited.
            preexec_fn=_hear_all if os.name == "posix" else None,
        )

    return started


def _hear_all() -> None:
    for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(one, signal.SIG_DFL)
