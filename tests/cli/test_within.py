"""Commands end within the time they are given, with what they have and a sentence about what is left out."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path

import numba
import numpy as np
import pytest
from numba.core import event

import trunnion as tn
from trunnion.cli import output
from trunnion.design.assessment.check import Status
from trunnion.equations.coefficients import assemble
from trunnion.numerics.jit import NoCodeCache, caches_of
from trunnion.numerics.threads import on_threads
from trunnion.response.orders.response import response_about
from trunnion.response.ranges.largest import SearchedQuantity, search
from trunnion.waiting import OutOfTime, keep_time, time_is_up, time_limit, uncounted

posix = pytest.mark.skipif(sys.platform == "win32", reason="a console of its own would get the Ctrl-C")
PTO = Path(__file__).parents[2] / "examples" / "pto-shaft.toml"
ENDED = "ended the search"
PATIENCE = 150.0
"""Seconds beyond its limit that a command may take where it compiles first, on a busy machine."""

LIMITED = """
[[limit]]
of = "Shaft 1"
max_torque = "2 kN*m"
"""
LONG = """\
format = 1
name = "long"

[operation]
speed = "1500 rpm"
speed_range = ["300 rpm", "3000 rpm"]
angle_range = ["0 deg", "20 deg"]
"""
PART = """
[[element]]
type = "Shaft"
stiffness = "{stiffness} kN*m/rad"
damping = "3 N*m*s/rad"

[[element]]
type = "Disk"
inertia = "{inertia} kg*m^2"

[[element]]
type = "HookeJoint"
angle = "{angle} deg"
"""
END = """
[[element]]
type = "Shaft"
stiffness = "10 kN*m/rad"
damping = "2 N*m*s/rad"

[[element]]
type = "Disk"
inertia = "0.5 kg*m^2"
excitation = [{ order = 2, amplitude = "100 N*m" }]
"""


@pytest.fixture
def long(here):
    """A file of a line that takes every analysis far longer than the limits of these tests."""
    parts = [PART.format(stiffness=9 + 3 * k, inertia=0.1 + 0.05 * k, angle=4 + k) for k in range(9)]
    begin = '\n[[element]]\ntype = "ConstantSpeed"\n'
    path = here / "long.toml"
    path.write_text(LONG + LIMITED + begin + "".join(parts) + END, encoding="utf-8")
    return str(path.name)


TABLE = {
    "assess": ("assess", "{long}"),
    "assess --remedies": ("assess", "{long}", "--remedies"),
    "analyze": ("analyze", "{long}", "-o", "report.html"),
    "analyze --submission": ("analyze", "{long}", "-o", "report.html", "--submission"),
    "optimise": ("optimise", "{long}", "-f", "Shaft 2.fork_offset:-90deg:90deg", "-a", "least spare margin"),
    "run-up": ("run-up", "{long}", "-a", "5 rpm"),
    "stable-limit": ("stable-limit", "{long}", "-p", "HookeJoint *.angle:0deg:30deg"),
    "stable-windows": ("stable-windows", "{long}", "-p", "HookeJoint *.angle:0deg:30deg"),
    "minimum-damping": ("minimum-damping", "{long}"),
    "tolerance-study": ("tolerance-study", "{long}", "-t", "Shaft *.stiffness=10%"),
    "certify-stability": (
        "certify-stability", "two-shaft-cardan", "-t", "Shaft *.stiffness=10%", "-t", "Disk *.inertia=10%",
        "--speed", "1.2:1.4",
    ),
    "certify-chaos": ("certify-chaos", "duffing", "--periods", "1000000"),
}  # fmt: skip


@pytest.mark.parametrize("command", TABLE)
def test_a_command_ends_in_time_and_says_so(run, here, long, command):
    begun = time.monotonic()
    result = run(*(part.format(long=long) for part in TABLE[command]), "--within", "0.3 s")
    assert time.monotonic() - begun < 0.3 + PATIENCE
    said = result.stdout + result.stderr
    assert "time limit of 0.3 s" in said, said
    assert result.exit_code in (0, 1), said
    if result.exit_code:  # nothing was known, or a run did not come to its end: one line
        (line,) = [line for line in result.stderr.splitlines() if line.startswith("error:")]
        assert "time limit of 0.3 s" in line
    assert "satisfied:" not in result.stdout  # nothing that was not searched holds


def test_a_report_that_is_cut_short_is_a_page_and_names_the_time_that_was_given(run, here, long):
    """Even where the verdict has taken all of it: what was not searched is said on it."""
    result = run("analyze", long, "--submission", "-o", "page.html", "--within", "0.4 s")
    assert result.exit_code == 0, result.output
    page = (here / "page.html").read_text(encoding="utf-8")
    named = {*re.findall(r"time limit of ([^ ]+) s", result.output + page)}
    assert named == {"0.4"} and page.rstrip().endswith("</html>")


def test_time_that_is_no_time_is_refused(run):
    for text in ("0", "-2 s", "soon", "3 m"):
        result = run("assess", "line.toml", "--within", text)
        assert result.exit_code == 2 and result.stderr.startswith("error: --within"), result.stderr


def test_with_time_enough_the_answer_is_the_same(run, here):
    plain = run("assess", "line.toml", "--json")
    timed = run("assess", "line.toml", "--json", "--within", "10 min")
    assert timed.exit_code == 0, timed.stderr
    assert json.loads(timed.stdout) == json.loads(plain.stdout)


def test_json_says_what_was_not_reached(run, here, long):
    result = run("assess", long, "--json", "--within", "10 ms")
    content = json.loads(result.stdout)
    assert content["verdict"] == "not judged" and ENDED in content["sentence"]
    stability = next(check for check in content["checks"] if check["name"] == "parametric stability")
    assert stability["status"] == "not judged"
    assert "300 rpm to 3000 rpm not judged" in stability["because"]


@posix
@pytest.mark.slow
@pytest.mark.parametrize("command", ["certify-chaos", "assess --remedies"])
def test_ctrl_c_gives_what_there_is(start, here, long, command):
    """The first one asks for an end; the answer is that of what was known by then, and the exit code says so."""
    process = start(*(part.format(long=long) for part in TABLE[command]))
    time.sleep(8)  # it computes
    if process.poll() is not None:
        pytest.skip("this machine is too fast for it")
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    assert output.STOPPING in err or not out
    last = err.splitlines()[-1]
    assert last in ("error: interrupted; this is what was known by then", "error: interrupted; nothing was written")
    if out:
        assert "the search was stopped" in out + err


def test_time_left_is_told_once_it_is_known(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(output.time, "monotonic", lambda: now[0])
    clock = output._Clock()

    def left(after, share):
        now[0] = 100.0 + after
        return clock.left(share)

    assert left(3.0, 1e-4) == ""  # little is done
    assert left(10.0, 0.10) == ""  # nothing to compare it with but that, which says ten times as much
    assert left(20.0, 0.20) == "about 80 s left"
    assert left(50.0, 0.90) == ""  # the pace has changed
    assert clock.left(0.0) == ""


@pytest.mark.parametrize("seconds", [0, -1.0, float("nan"), float("inf"), "3 s", True])
def test_a_limit_is_a_positive_number_of_seconds(seconds):
    with pytest.raises(tn.errors.InputError, match="positive time"), time_limit(seconds):
        pass


def test_limits_within_one_another_and_on_threads():
    with time_limit(1e-9), time_limit(1000.0):
        with pytest.raises(OutOfTime, match="1e-09 s"):
            keep_time()
    assert not time_is_up()
    seen = []

    def work(task):
        seen.append(task)
        limit.stop()

    with time_limit() as limit:
        with pytest.raises(OutOfTime, match="stopped"):
            on_threads(work, range(100), 2)
        assert limit.noticed
    assert 1 <= len(seen) <= 2


def test_what_happens_once_on_a_machine_is_no_processor_time_of_a_limit():
    def work(seconds: float) -> None:
        begun = time.process_time()
        while time.process_time() - begun < seconds:
            pass

    with time_limit(0.2, of_processor=True) as outer, time_limit(30.0) as elapsed, time_limit(0.1, of_processor=True):
        ends = elapsed.ends
        work(0.3)
        uncounted(0.15)
        assert not outer.over and time_is_up()  # the inner one had 0.1 s, and 0.05 s were its own
        uncounted(0.1)
        assert not time_is_up() and elapsed.ends == ends


def test_compiling_takes_nothing_from_the_time_of_a_report():
    import numba

    with time_limit(0.5, of_processor=True) as limit, output.compile_notice():
        from trunnion.numerics import jit  # noqa: F401

        for k in range(3):
            numba.njit(eval(f"lambda x: sum([x[i] * {k} for i in range(len(x))])"))(np.arange(3.0))
        ends = limit.ends - limit.clock()
        assert ends > 0.3


def test_time_to_compile_a_c_function_is_told_as_that_of_any_other():
    """numba itself tells that of what a C function calls only: a quarter of a first report went uncounted."""
    told: list[str] = []

    class Heard(event.Listener):
        def on_start(self, event):
            told.append("begins")

        def on_end(self, event):
            told.append("ends")

    with event.install_listener("numba:compile", Heard()), caches_of(NoCodeCache):
        numba.cfunc("float64(float64)", cache=True)(lambda x: x + 1.0)
        with pytest.raises(numba.TypingError):
            numba.cfunc("float64(float64)", cache=True)(lambda x: x + nothing)  # noqa: F821
    assert told == ["begins", "ends"] * 2


def test_another_thread_can_stop_an_analysis():
    """The verdict that a stop leaves is that of what was searched: nothing is satisfied in silence."""
    shafts, disk, joint = [tn.Shaft(stiffness=9e3 + k, damping=2.0) for k in range(11)], tn.Disk(inertia=0.2), 0.1
    parts = [part for shaft in shafts[1:] for part in (shaft, disk, tn.HookeJoint(angle=joint))]
    line = tn.Driveline([tn.ConstantSpeed(), *parts, shafts[0], tn.Disk(inertia=0.4)])
    with time_limit() as limit:
        timer = threading.Timer(0.2, limit.stop)
        timer.start()
        found = tn.assess(line, (30.0, 300.0))
        timer.cancel()
    if not limit.noticed:
        pytest.skip("this machine is too fast for it")
    assert found.verdict is Status.NOT_JUDGED and found.sentence.endswith("the search was stopped")


def test_a_search_that_is_cut_short_does_not_call_its_largest_value_the_largest():
    """It knows the value, which may be exceeded already, and nothing of what it did not reach."""
    engine = tn.Disk(inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0}])
    assembly = assemble(tn.Driveline([engine, tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)]))
    torque = SearchedQuantity(lambda r: np.abs(r.torque[:, :, 0]).sum(axis=1), lambda r: r.torque[:, :, 0])
    grid = np.linspace(60.0, 160.0, 9)
    values = torque.values(response_about(assembly, grid))
    whole = search(assembly, partial(response_about, assembly), [grid], [torque])
    with time_limit() as limit:

        def respond(speeds):
            answer = response_about(assembly, speeds)
            limit.stop()
            return answer

        found = search(assembly, respond, [grid], [torque])
    assert found.ended == "the search was stopped" and np.all(np.isinf(found.error))
    assert found.value[0] == pytest.approx(values.max(), rel=1e-12)
    assert not whole.ended and whole.value[0] > 1.2 * found.value[0]  # the resonance lies between the nine


@pytest.mark.parametrize("within", [0.01, 0.4])
def test_python_keeps_the_limit_too(within):
    line = tn.catalogue("three-shaft-cardan")
    begun = time.monotonic()
    try:
        found = tn.minimum_damping(line, (0.2, 3.0), within=within)
        assert found.ended and not found.complete and not len(found.windows)
    except OutOfTime as error:
        assert f"{within:g} s" in str(error)
    assert time.monotonic() - begun < within + PATIENCE


def test_certificates_leave_the_rest_undecided():
    found = tn.certify_stability(
        tn.catalogue("two-shaft-cardan"), {"Shaft *.stiffness": 0.1, "Disk *.inertia": 0.1}, (1.2, 1.4), within=0.05
    )
    assert found.verdict == "undecided" and found.undecided_share > 0 and ENDED in str(found)


def test_a_study_of_fewer_scrambles_has_a_wider_interval():
    line, spread = tn.catalogue("two-shaft-cardan"), {"Shaft *.stiffness": 0.1}
    whole = tn.tolerance_study(line, spread, [1.6], samples=1 << 12)
    assert not whole.ended

    stopped = {}
    with time_limit() as limit:

        def after_a_third(share):
            if share > 0.35:
                limit.stop()
                stopped["at"] = share

        part = tn.tolerance_study(line, spread, [1.6], samples=1 << 12, progress=after_a_third)
    assert stopped and 2 * 256 <= part.samples < whole.samples and part.samples % 256 == 0
    assert part.ended and "left out the rest" in str(part)
    assert part.growth_rate.shape == (1, part.samples)
    np.testing.assert_allclose(part.growth_rate[0], whole.growth_rate[0, : part.samples], rtol=1e-6, atol=1e-9)
    low, high = part.interval
    assert low <= whole.probability + 0.1 and high >= whole.probability - 0.1


@pytest.mark.slow
def test_a_first_report_has_its_chart(tmp_path, monkeypatch):
    """Where everything has to be compiled first too."""
    monkeypatch.chdir(tmp_path)
    environment = {**os.environ, "TRUNNION_CACHE": str(tmp_path / "cache")}
    told = subprocess.run(
        [sys.executable, "-m", "trunnion", "analyze", str(PTO)], env=environment, capture_output=True, text=True
    )
    assert told.returncode == 0 and "compiling once" in told.stderr
    assert "chart was not computed" not in told.stdout and "stability-chart.nc" in told.stdout
