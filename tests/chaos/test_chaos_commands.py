"""The commands lyapunov-spectrum, poincare-map and certify-chaos: what they print, write and refuse."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from trunnion.cli.program import app


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]):  # type: ignore[no-untyped-def]
    """Runs a command in an empty folder: exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)

    def call(*words: str) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as ended:
            app(list(words))
        out = capsys.readouterr()
        return int(ended.value.code or 0), out.out, out.err

    return call


def test_lyapunov_spectrum(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    code, out, _ = run("lyapunov-spectrum", "ueda", "--periods", "300", "--set", "force=7.5")
    assert code == 0 and "L1 = +0." in out and "sum -0.05" in out
    assert sorted(p.name for p in (tmp_path / "trunnion-out").iterdir()) == ["ueda-exponents.nc", "ueda-exponents.png"]
    code, out, _ = run("lyapunov-spectrum", "lorenz", "--duration", "200", "--json", "-o", "l.nc")
    found = json.loads(out)
    assert code == 0 and len(found["exponents"]) == 3
    assert found["sum"] == pytest.approx(-41 / 3, abs=1e-8)


def test_poincare_map(run) -> None:  # type: ignore[no-untyped-def]
    code, out, _ = run("poincare-map", "rossler", "--section", "y=0", "--set", "c=4", "--points", "200", "-o", "m.png")
    assert code == 0 and "repeats after 4 points" in out and Path("m.png").stat().st_size > 5000
    code, out, _ = run("poincare-map", "lorenz", "--section", "z=27:-", "--points", "50", "--json")
    assert len(json.loads(out)["states"]["x"]) == 50


@pytest.mark.slow
def test_certify_chaos(run) -> None:  # type: ignore[no-untyped-def]
    code, out, _ = run(
        "certify-chaos", "ueda", "--periods", "400", "--sweep", "frequency:0.95:1.05:3", "-o", "c.png", "--json"
    )
    found = json.loads(out)
    assert (code, found["verdict"]) == (0, "chaotic")
    assert [c["discriminates"] for c in found["criteria"]] == [True, False, False]
    code, out, _ = run("certify-chaos", "ueda", "--periods", "20", "--sweep", "force:7:8:2", "-o", "c.png")
    assert code == 0 and "undecided" in out and "would decide" in out


def test_double_tripod_and_lines(run) -> None:  # type: ignore[no-untyped-def]
    words = ("--duration", "0.4", "--starts", "1", "--json", "-o", "s.nc")
    code, out, _ = run("lyapunov-spectrum", "double-tripod:output", "--set", "damping_ratio=0.02", *words)
    assert code == 0 and json.loads(out)["sum"] == pytest.approx(-2 * 0.02 * 8771.0, rel=1e-4)
    code, out, _ = run("lyapunov-spectrum", "two-shaft-cardan", "--speed", "1.1 rad/s", "--periods", "100", "--json")
    # So few periods cannot tell exponents of this size from what shear alone may show, and the answer says so.
    found = json.loads(out)
    assert code == 1 and found["outcome"] == "not converged" and len(found["exponents"]) == 4
    code, out, _ = run("catalogue", "double-tripod")
    assert code == 0 and "9633.73 rad/s" in out


REFUSED = {
    "no period": (("poincare-map", "lorenz"), "section"),
    "never crossed": (("poincare-map", "lorenz", "--section", "z=270", "--points", "5"), "crossed 0 times"),
    "blow-up": (("poincare-map", "mathieu", "--set", "a=1"), "blows up"),
    "section": (("poincare-map", "lorenz", "--section", "z>2"), "STATE=LEVEL"),
    "sweep": (("certify-chaos", "ueda", "--sweep", "force"), "NAME:LOW:HIGH:N"),
    "parameter": (("lyapunov-spectrum", "ueda", "--set", "mass=1"), "parameters are"),
    "value": (("lyapunov-spectrum", "ueda", "--set", "force"), "NAME=VALUE"),
    "speed": (("lyapunov-spectrum", "ueda", "--speed", "3"), "drivelines"),
    "file": (("certify-chaos", "nothing"), "neither a file"),
    "element": (("certify-chaos", "double-tripod:middle"), "input"),
    "line": (("stability", "double-tripod"), "not a driveline"),
    "start": (("lyapunov-spectrum", "ueda", "--start", "1,2,3", "--periods", "100"), "start"),
    "picture": (("lyapunov-spectrum", "ueda", "--periods", "100", "-o", "a.csv"), "csv"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_in_one_line(run, case: str) -> None:  # type: ignore[no-untyped-def]
    words, said = REFUSED[case]
    code, out, err = run(*words)
    assert code == (1 if case in ("never crossed", "blow-up") else 2)
    lines = [line for line in err.splitlines() if not line.startswith("compiling")]
    assert len(lines) == 1 and lines[0].startswith("error: ") and said in lines[0], err
    assert out == ""
