"""What the README says that Trunnion does not do is still so, line by line, and what it names in its place works."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial

import feature_lines as lines
import numpy as np
import pytest
from as_printed import ROOT

import trunnion as tn
from trunnion.errors import InputError
from trunnion.results.verdict import Verdict

SPEED = 100.0
AXES = (("speed", 90.0, 110.0, 3), ("joint.angle", 0.1, 0.3, 2))


def refused(call: Callable[[], object], why: str) -> None:
    with pytest.raises(InputError, match=why):
        call()


def of_the_readme() -> tn.Driveline:
    """Its natural frequencies are 74.158 and 246.18 rad/s."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness="12 kN*m/rad", damping="1 N*m*s/rad"),
            tn.Disk(inertia="0.4 kg*m^2"),
            tn.HookeJoint(angle="20 deg"),
            tn.Shaft(stiffness="10 kN*m/rad", damping="1 N*m*s/rad"),
            tn.Disk(inertia="0.9 kg*m^2"),
        ]
    )


def no_bending() -> None:
    stiff, soft = (lines.with_tube().replace("rear", young_modulus=modulus) for modulus in (4.2e11, 2.1e11))
    ratio = tn.bending_speeds(stiff)[0].critical_speed / tn.bending_speeds(soft)[0].critical_speed
    assert ratio == pytest.approx(np.sqrt(2.0), rel=1e-9)
    np.testing.assert_array_equal(*(tn.natural_frequencies(line).frequency for line in (stiff, soft)))


def forced_twist() -> None:
    """Multipliers about the motion found by shooting, in equations that are not linear, know what is left out."""
    line = lines.bent().replace("load", load_torque=3000.0)
    true = tn.periodic_response(line, SPEED, compare=False).spectral_radius
    left, counted = (tn.stability(line, SPEED, about_steady_state=own) for own in (False, True))
    assert counted.spectral_radius == pytest.approx(true, abs=1e-9)
    assert abs(left.spectral_radius - true) > 1e-6 > 100 * left.error_estimate
    chart = tn.stability_chart(line, *AXES, about_steady_state=True)
    assert chart.at(SPEED, 0.2).spectral_radius == pytest.approx(true, abs=1e-8)
    chart = tn.stability_chart(line, *AXES)
    assert chart.at(SPEED, 0.2).spectral_radius == pytest.approx(left.spectral_radius, abs=1e-8)
    resonant, quiet = (tn.stability(of_the_readme(), speed).findings for speed in (74.158 / 2, 50.0))
    assert "beyond the linear range" in " ".join(one.sentence for one in resonant)
    assert "beyond the linear range" not in " ".join(one.sentence for one in quiet)


def free_with_play() -> None:
    plain = lines.free(lines.bent())
    staged = lines.free(lines.staged()(lines.bent()))
    for call in (partial(tn.stability_chart, plain, *AXES), partial(tn.order_response, plain, [SPEED])):
        call()
    for call in (partial(tn.stability_chart, staged, *AXES), partial(tn.order_response, staged, [SPEED])):
        refused(call, "stages or play")
    found, true = tn.stability(staged, SPEED), tn.periodic_response(staged, SPEED, compare=False)
    assert found.spectral_radius == pytest.approx(true.spectral_radius, abs=1e-8)


def one_stage() -> None:
    """Inside a stage its stiffness alone counts; the load decides which."""
    for load, stiffness in ((0.5, 5e3), (200.0, 1e4)):
        line = lines.straight().replace("load", load_torque=load, excitation=())
        as_shaft = lines.swap(line, "rear", tn.Shaft(stiffness=stiffness, damping=5, name="rear"))
        found, linear = (tn.stability(one, SPEED).multipliers for one in (line, as_shaft))
        np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(linear), rtol=1e-8)


def dry_friction() -> None:
    rubs = lines.clutch(True)(lines.bent())
    assert tn.simulate(rubs, turns=1.0, speed=SPEED).outcome.ok
    assert tn.periodic_response(rubs, SPEED, compare=False).outcome.ok
    assert tn.sweep(lines.clutch(True)(lines.straight()), [90.0, 91.0])
    refused(lambda: tn.stability(rubs, SPEED), "linear equations have none")
    stated = lines.clutch(True, linear_amplitude=0.01, linear_frequency=300.0)(lines.bent())
    assert tn.stability(stated, SPEED).verdict is Verdict.STABLE
    for line in (rubs, stated):
        refused(partial(tn.periodic_branch, line, "speed", 90.0, 100.0), "does not follow")


def between_points() -> None:
    line = of_the_readme()
    x, y = ("speed", tn.rpm(2250), tn.rpm(2450)), ("HookeJoint 1.angle", 0.3, 0.36)
    chart = tn.stability_chart(line, (*x, 2), (*y, 2))
    assert np.all(chart.verdict == Verdict.STABLE)
    assert tn.stability(line, tn.rpm(2350)).verdict is Verdict.UNSTABLE
    assert len(tn.tongues(line, x, y).tongues) == 1


SHOWN: dict[str, Callable[[], None]] = {
    "Drivelines have no bending of shafts": no_bending,
    "Charts and `tn.stability` leave out the twist that joints force": forced_twist,
    "Play or stages beside the joint angles of a free–free line": free_with_play,
    "Of a gear mesh with backlash or a damper with stages": one_stage,
    "Dry friction of a `Clutch`": dry_friction,
    "Pictures show points": between_points,
}
"""How each sentence begins, and what shows it."""


@pytest.mark.filterwarnings("ignore::trunnion.InputRemark")
@pytest.mark.parametrize(
    "show",
    [pytest.param(show, marks=pytest.mark.slow) if show is forced_twist else show for show in SHOWN.values()],
    ids=list(SHOWN),
)
def test_it_is_still_so(show: Callable[[], None]) -> None:
    show()


def test_every_line_is_shown() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    section = re.search(r"^## What it does not do\n(.*?)^## ", text, re.MULTILINE | re.DOTALL)
    assert section
    said = re.findall(r"^- (.*)$", section[1], re.MULTILINE)
    assert len(said) == len(SHOWN)
    for line, begins in zip(said, SHOWN, strict=True):
        assert line.startswith(begins)
