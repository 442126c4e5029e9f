"""What only shows in a process of its own: light imports, streams, exit codes, Ctrl-C."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time

import pytest

HEARD = """
import sys
from trunnion.cli import program
app = program.app
def answering(arguments):
    print("ready", flush=True)  # from here on a Ctrl-C is answered by the program, not by Python
    app(arguments)
program.app = answering
program.main()
"""
HEAVY = ("numba", "scipy", "xarray", "matplotlib", "h5py", "pint", "pandas")


def test_light_imports(start):
    """The package, help, help of a command and the list of starters, one after the other."""
    script = (
        "import sys\n"
        "def loaded(by):\n"
        f"    print('HEAVY', by, [name for name in {HEAVY!r} if name in sys.modules])\n"
        "import trunnion\n"
        "loaded('import')\n"
        "from trunnion.cli import main\n"
        "for words in (['--help'], ['analyze', '--help'], ['new']):\n"
        "    try:\n        main(words)\n"
        "    except SystemExit as leave:\n        assert not leave.code\n"
        "    loaded(words)\n"
    )
    code, out, err = finished(start(program=("-c", script)))
    assert code == 0, err
    said = [line for line in out.splitlines() if line.startswith("HEAVY")]
    assert len(said) == 4 and all(line.endswith(" []") for line in said), said


def test_the_answer_loads_no_compiler(start):
    """Verdict, checks and findings of a jointed line that swings, stability about its own motion included."""
    script = (
        "import sys, trunnion as tn\n"
        "from trunnion.cli import output\n"
        "from trunnion.reporting.overview_assessment import answer, asked, judged\n"
        "with output.compile_notice():\n"
        "    given = answer(judged(asked(tn.load('line.toml'))))\n"
        "assert given.along is not None\n"
        "assert 'trunnion.steady.free.periodic_steady_states' in sys.modules\n"
        "print([name for name in ('numba', 'matplotlib', 'xarray') if name in sys.modules])\n"
    )
    code, out, err = finished(start(program=("-c", script)))
    assert code == 0, err
    assert out.splitlines()[-1] == "[]"


def test_compiling_is_said_once(start, tmp_path):
    """However many parts of a command compile."""
    script = (
        "from trunnion.cli import output\n"
        "for _ in range(2):\n"
        "    with output.compile_notice() as compiling:\n"
        "        import numba\n"
        "        from trunnion.numerics import jit\n"
        "        numba.njit(lambda x: x + 1)(1)\n"
        "        assert compiling.seconds() > 0\n"
    )
    code, _, err = finished(start(program=("-c", script)))
    assert code == 0, err
    assert err.count("compiling once") == 1


def finished(process):
    out, err = process.communicate(timeout=300)
    return process.returncode, out, err


def test_json_is_alone_on_stdout(start):
    code, out, err = finished(start("stability-chart", "line.toml", "--points", "12x6", "--json"))
    assert code == 0, err
    assert json.loads(out)["x"]["points"] == 12


def test_the_package_itself_is_the_command_too(start):
    code, out, err = finished(start("--version", program=("-m", "trunnion")))
    assert (code, err) == (0, "") and out.startswith("trunnion ")


def test_bad_input(start):
    code, out, err = finished(start("stability", "line.toml", "--speed", "0"))
    assert code == 2
    assert out == ""
    assert err.splitlines() == ["error: --speed = '0': must be positive; write \"1500 rpm\", say"]


def test_a_narrow_encoding_does_not_break_the_output(start):
    code, out, err = finished(start("resonance-speeds", "line.toml", encoding="ascii"))
    assert code == 0, err
    assert "?2/2" in out or "??/2" in out


@pytest.mark.skipif(sys.platform == "win32", reason="a console of its own would get the Ctrl-C")
@pytest.mark.parametrize(
    ("asked", "later"),
    [
        # A signal is heard the same way while it computes, whichever it is: Ctrl-C stands for the others.
        pytest.param(
            asked,
            later,
            id=f"{asked}-while it {'computes' if later else 'starts'}",
            marks=[pytest.mark.slow] * (later and asked != "SIGINT"),
        )
        for asked in ("SIGINT", "SIGTERM", "SIGHUP")
        for later in (False, True)
    ],
)
def test_who_is_asked_to_end_leaves_nothing(start, here, later, asked):
    """Ctrl-C, and what a scheduler, a service or a closing terminal sends."""
    before = sorted(os.listdir(here))
    process = start("stability-chart", "line.toml", "--points", "5000x5000", program=("-c", HEARD))
    assert process.stdout.readline() == "ready\n"
    if later:
        time.sleep(3)  # whatever it is doing by then
    assert process.poll() is None
    process.send_signal(getattr(signal, asked))
    out, err = process.communicate(timeout=60)
    assert process.returncode == {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129}[asked]
    assert out == ""
    assert err.splitlines()[-1] == "error: interrupted; nothing was written"
    assert "Traceback" not in err
    assert sorted(os.listdir(here)) == before


@pytest.mark.skipif(sys.platform == "win32", reason="a console of its own would get the Ctrl-C")
@pytest.mark.slow
def test_ctrl_c_keeps_the_answer_and_the_report_without_its_chart(start, here):
    process = start("analyze", "line.toml", "--points", "4000x4000", "-o", "kept.html", program=("-c", HEARD))
    deadline = time.monotonic() + 120
    while not (here / "kept.html").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(1)  # into the chart, which has millions of points
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert "Checks from 600 rpm" in out and "Findings" in out
    assert err.splitlines()[-1] == "error: interrupted; the report without its chart is in kept.html"
    page = (here / "kept.html").read_text(encoding="utf-8")
    assert page.endswith("</html>") and "was still computing it, or was interrupted" in page
    assert sorted(os.listdir(here)) == ["kept.html", "line.toml"]


@pytest.mark.slow
def test_warm_up_fills_the_cache_and_leaves_it_as_it_is(tmp_path):
    """A second run compiles nothing anew; each part runs by itself."""
    from trunnion.cli.warm_up import PARTS

    environment = {**os.environ, "TRUNNION_CACHE": str(tmp_path / "kept"), "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-m", "trunnion", "warm-up", "--part", "reports and motions"]
    assert command[-1] in PARTS
    written = []
    for _ in range(2):
        subprocess.run(command, env=environment, check=True, timeout=600)
        written.append({p: p.stat().st_mtime_ns for p in (tmp_path / "kept").rglob("*.nb*")})
    assert written[0] and written[1] == written[0]


def test_warm_up_says_in_one_line_that_nothing_can_be_kept(tmp_path):
    (tmp_path / "file").write_text("")
    environment = {**os.environ, "TRUNNION_CACHE": str(tmp_path / "file"), "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(
        [sys.executable, "-m", "trunnion", "warm-up"], env=environment, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.count("\n") <= 2 and "cannot be written" in done.stderr.splitlines()[-1]
