"""S1 computed anew: numbers of its tables, the errata's evidence, what its conclusions rest on."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.papers.shared.result import Reproduction
from trunnion.papers.two_shaft_cardan.errata import difference_tongue, errata
from trunnion.papers.two_shaft_cardan.printed_matrices import matrices
from trunnion.papers.two_shaft_cardan.study import TABLE_1, TABLE_2
from trunnion.papers.two_shaft_cardan.twists import spectral_radii

SLOW = pytest.mark.slow


@pytest.fixture(scope="module")
def found(study) -> Reproduction:  # type: ignore[no-untyped-def]
    return study("two-shaft-cardan")


def remarks(found: Reproduction) -> dict[str, str]:
    return {row.place: row.remark for table in found.tables for row in table.rows}


@SLOW
def test_natural_frequencies_beside_the_printed(found: Reproduction) -> None:
    rows = found.tables[0].rows
    assert [(r.published, r.computed) for r in rows] == [("0.072", "0.07062"), ("1.422", "1.41598")]
    assert all("equation 25" in r.remark for r in rows)


@SLOW
def test_every_entry_of_the_tables_is_there(found: Reproduction) -> None:
    printed = [f"{value:.3f}" for *_, value in (*TABLE_1, *TABLE_2)]
    assert [r.published for table in found.tables[1:] for r in table.rows] == printed


@SLOW
def test_tongues_start_at_the_named_resonances(found: Reproduction) -> None:
    named = {p: r for p, r in remarks(found).items() if p.startswith(("harmonic", "subharmonic", "sum"))}
    assert named
    for place, remark in named.items():
        assert "within a pixel" in remark, (place, remark)


@SLOW
def test_difference_resonances_stay_shut(found: Reproduction) -> None:
    shut = {p: r for p, r in remarks(found).items() if p.startswith("difference")}
    assert len(shut) == 2
    for remark in shut.values():
        reach = float(re.search(r"β = ([\d.]+)", remark).group(1))  # type: ignore[union-attr]
        assert "does not open" in remark and reach > 0.9


@SLOW
def test_errata_evidence() -> None:
    rows = {r.place: r for r in errata().rows}
    assert rows["E₂₁, P₂₁ as printed"].computed.startswith("100.0 %")
    assert rows["sign of P₂₁ mended"].computed.startswith("0.0 %")
    assert "±" in rows["derived"].remark


def test_maximum_of_the_false_tongue_is_refined() -> None:
    """Against the same matrices integrated by scipy, at the maximum and beside it."""
    at, height, derived = difference_tongue()
    assert _by_scipy("single", at) == pytest.approx(height, abs=1e-7)
    assert all(_by_scipy("single", at + d) < height for d in (-2e-4, 2e-4))
    assert height == pytest.approx(1.02604, abs=1e-5) and derived < 0.9996


def _by_scipy(version: str, speed: float) -> float:
    def rate(tau: float, z: np.ndarray) -> np.ndarray:
        e, p = matrices(version, np.asarray(tau), speed, 0.5, 0.001, 1.0, 1.0, 100.0)
        y = z.reshape(4, 4)
        return np.vstack([y[2:], -(p @ y[:2] + e @ y[2:])]).ravel()

    end = solve_ivp(rate, (0, np.pi), np.eye(4).ravel(), method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    return float(np.abs(np.linalg.eigvals(end.reshape(4, 4))).max())


def test_equations_in_twists_agree_with_the_general_ones() -> None:
    """Figure 2a's own equations and integrator."""
    speed, angle = np.array([0.37, 0.9, 1.41]), np.array([0.0, 0.5, 0.9])
    radii = spectral_radii(speed, angle, 100.0, 0.001)
    for i, beta in enumerate(angle):
        line = tn.catalogue("two-shaft-cardan", angle=float(beta), inertia_of_disk_2=100.0)
        right = [tn.stability(line, float(s)).spectral_radius for s in speed]
        assert radii[i] == pytest.approx(right, abs=2e-6)


@SLOW
def test_conclusions(found: Reproduction) -> None:
    held = {c.statement.split(".")[0]: c.holds for c in found.conclusions}
    assert held["A larger joint angle widens the unstable regions"] == "confirmed"
    assert held["Difference combinations are among the resonances (Table 2), γ = 100"] == "corrected"
    for words in ("stiffer", "More damping", "A higher speed"):
        assert next(h for s, h in held.items() if words in s) == "not decided"
    assert all(re.search(r"\d", c.evidence) for c in found.conclusions)


@SLOW
def test_figures_2_to_7(found: Reproduction) -> None:
    assert [f.number for f in found.figures] == ["2a", "2b", "3", "4", "5", "6", "7"]
    slow, fast = found.figure("2b").charts
    assert slow.x[-1] == 0.4 and (fast.x[0], fast.x[-1]) == (0.25, 2.0)
    for chart in (slow, fast):
        assert 0 < chart.unstable_share < 0.5
    # the tongue at ω₂, β = 0.5: known edges to the width of a pixel
    row = fast.verdict[int(np.abs(fast.y - 0.5).argmin())] == 1
    tongue = fast.x[row & (fast.x > 1.2)]
    pixel = fast.x[1] - fast.x[0]
    assert tongue.min() == pytest.approx(1.372337, abs=1.5 * pixel)
    assert tongue.max() == pytest.approx(1.464882, abs=1.5 * pixel)


@SLOW
def test_folder(found: Reproduction, tmp_path: Path) -> None:
    written = found.save(tmp_path / "out")
    assert {p.suffix for p in written} == {".png", ".html"}
    assert len(written) == 1 + len(found.figures) + len(found.evidence)
    page = written[0].read_text(encoding="utf-8")
    assert page.count("<img ") == len(written) - 1
    assert not re.search(r"https?://", page)
    assert "<script" not in page and "<link" not in page
    text = unescape(page)
    for row in found.errata.rows:
        assert row.remark in text


def test_unknown_paper() -> None:
    with pytest.raises(tn.InputError, match="two-shaft-cardan"):
        tn.reproduce("bicardan")
    with pytest.raises(tn.InputError, match="points"):
        tn.reproduce("two-shaft-cardan", points=3)
