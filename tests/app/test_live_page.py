"""A line in motion in a browser, from a file, with the network cut: what stands in the picture against what was
computed, without WebGL too, with hostile names, by keyboard, and at rest for who wants it so."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import trunnion as tn
from trunnion.animation.animation import Animation, together

HOSTILE = '</script><img src=x onerror="window.hacked=1">'
UNSTABLE = 1.62
"""Speed [rad/s] in a tongue of the two-shaft line."""
PLAYER = "document.getElementById('trunnion-player').player"


def lines() -> Animation:
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle="18 deg", name=HOSTILE),
            tn.Shaft(stiffness=1200.0, damping=0.5, fork_offset="12 deg", name="tube"),
            tn.Disk(inertia=0.05, name="middle"),
            tn.GearPair(teeth_in=20, teeth_out=40, mesh_stiffness="2e7 N/m", mesh_damping="300 N*s/m", module="4 mm"),
            tn.Disk(inertia=0.1, name="wheel"),
            tn.HookeJoint(angle="24 deg", plane="25 deg", name="second"),
            tn.Coupling(stiffness=900.0, damping=0.8, name="rear"),
            tn.Disk(inertia=0.4, load_torque=20.0, name="load"),
        ],
        name=HOSTILE,
    )
    found = [tn.animate(line, what, speed=40.0) for what in ("turning", "response", "disturbance")]
    unstable = tn.catalogue("two-shaft-cardan", angle=0.5, damping_ratio=0.001)
    return together(HOSTILE, [*found, tn.animate(unstable, "disturbance", speed=UNSTABLE)])


@pytest.fixture(scope="module")
def animation() -> Animation:
    return lines()


@pytest.fixture(scope="module")
def address(animation: Animation, tmp_path_factory: pytest.TempPathFactory) -> str:
    path: Path = animation.save(tmp_path_factory.mktemp("live") / "line.html")
    return path.as_uri()


@pytest.fixture
def opened(browser: Any) -> Iterator[Any]:
    """Opens pages in a browser that reaches no network, and hears of every request and error."""
    contexts = []

    def opens(address: str, **more: Any) -> Any:
        context = browser.new_context(offline=True, viewport={"width": 1000, "height": 700}, **more)
        contexts.append(context)
        page = context.new_page()
        page.asked, page.wrong = [], []
        page.on("request", lambda request: page.asked.append(request.url))
        page.on("pageerror", lambda error: page.wrong.append(str(error)))
        page.on("console", lambda said: page.wrong.append(said.text) if "ontent Security" in said.text else None)
        page.goto(address)
        page.wait_for_function(f"() => {PLAYER}?.wide > 0")
        return page

    yield opens
    for context in contexts:
        for page in context.pages:
            assert page.wrong == []
            assert [url for url in page.asked if not url.startswith(("file:", "blob:", "data:"))] == []
            assert page.evaluate("window.hacked") is None
        context.close()


def computed(animation: Animation, choice: int, time: float, factor: float) -> list[list[float]]:
    """Angles of every body at a time, from the frames."""
    shown = animation.motions[choice]
    one = shown.movements[0]
    times = one.time - one.time[0]
    period = times[-1]
    assert one.repeats
    within, wave = time % period, 1.0 + 0j
    if one.growth is not None:
        span = np.log(10.0) / max(abs(m.growth.real) for m in shown.movements if m.growth)
        wave = np.exp(one.growth * time) * (np.exp(-one.growth.real * span) if one.growth.real > 0 else 1.0)

    def at(part: np.ndarray) -> np.ndarray:
        return np.array([np.interp(within, times, column) for column in part.T])

    turned = at(one.rigid) + np.floor(time / period) * (one.rigid[-1] - one.rigid[0])
    moved = (at(one.deviation.real) + 1j * at(one.deviation.imag)) * wave
    angle = turned + factor * moved.real
    return [[angle[s] - off for s, off in zip(p.stations, p.turned, strict=True)] for p in shown.parts]


@pytest.mark.parametrize("flat", [False, True], ids=["webgl", "without webgl"])
def test_bodies_stand_where_the_frames_say(opened: Any, animation: Animation, address: str, flat: bool) -> None:
    page = opened(address + ("?flat" if flat else ""))
    assert page.evaluate(f"{PLAYER}.kind") == ("2d" if flat else "webgl")
    for choice in range(3):
        page.evaluate(f"{PLAYER}.choose({choice}); {PLAYER}.pause()")
        length = page.evaluate(f"{PLAYER}.whole")
        for share, factor in ((0.0, 1.0), (0.31, 1.0), (0.77, 4.0), (1.6, 0.5)):
            page.evaluate(f"{PLAYER}.factor = {factor}; {PLAYER}.seek({share * length})")
            seen = page.evaluate(f"{PLAYER}.read()")
            wanted = computed(animation, choice, share * length, factor)
            compared = 0
            for body, angles in zip(seen, wanted, strict=True):
                for one, other in zip(body["angles"], angles, strict=True):
                    if one is not None:
                        assert abs(np.sin((one - other) / 2)) < 2e-5, (choice, share, body)
                        compared += 1
            assert compared >= 12


def test_what_grows_stands_above_what_decays(opened: Any, animation: Animation, address: str) -> None:
    page = opened(address)
    page.evaluate(f"{PLAYER}.choose(3); {PLAYER}.pause()")
    sizes = []
    for share in (0.0, 1.0):
        page.evaluate(f"{PLAYER}.seek({share} * {PLAYER}.whole)")
        sizes.append([abs(complex(*page.evaluate(f"{PLAYER}.rows[{row}].envelope({PLAYER}.time)"))) for row in (0, 1)])
    assert sizes[0] == pytest.approx([0.1, 1.0])
    assert sizes[1][0] == pytest.approx(1.0) or sizes[1][1] == pytest.approx(0.1)
    assert sizes[1][0] > sizes[0][0]
    assert sizes[1][1] < sizes[0][1]
    for row, one in enumerate(animation.motions[3].movements):
        seen = page.evaluate(f"{PLAYER}.read({row})")
        assert np.isfinite([a for body in seen for a in body["angles"] if a is not None]).all()
        assert one.title == ("grows", "decays")[row]


def test_a_browser_without_webgl_falls_back_by_itself(opened: Any, address: str) -> None:
    page = opened(address)
    page.evaluate(
        f"""() => {{ const own = HTMLCanvasElement.prototype.getContext
        HTMLCanvasElement.prototype.getContext = function (kind, ...more) {{
          return kind.startsWith("webgl") ? null : own.call(this, kind, ...more) }}
        {PLAYER}.painter.dispose(); {PLAYER}.painter = null; {PLAYER}.restage() }}"""
    )
    assert page.evaluate(f"{PLAYER}.kind") == "2d"
    before = page.evaluate(f"{PLAYER}.canvas.toDataURL().length")
    assert before > 2000


def test_it_is_played_by_keys_and_names_are_text(opened: Any, address: str) -> None:
    page = opened(address)
    assert page.evaluate(f"{PLAYER}.playing")
    page.locator("canvas").focus()
    page.keyboard.press("Space")
    assert not page.evaluate(f"{PLAYER}.playing")
    time, turn, zoom = (page.evaluate(f"{PLAYER}.{key}") for key in ("time", "camera.turn", "camera.zoom"))
    for key in (".", "ArrowLeft", "+"):
        page.keyboard.press(key)
    assert page.evaluate(f"{PLAYER}.time") > time
    assert page.evaluate(f"{PLAYER}.camera.turn") != turn
    assert page.evaluate(f"{PLAYER}.camera.zoom") > zoom
    page.keyboard.press("Home")
    assert page.evaluate(f"{PLAYER}.camera.turn") == turn
    assert page.locator("h1").inner_text() == HOSTILE
    assert HOSTILE in page.locator(".label").all_inner_texts()
    page.get_by_label("Motion").select_option(index=3)
    captions = page.locator(".caption").all_inner_texts()
    assert [caption.split(":")[0] for caption in captions] == ["grows", "decays"]
    assert page.evaluate("document.querySelectorAll('canvas').length") == 1


def test_it_plays_and_takes_what_time_says(opened: Any, address: str) -> None:
    page = opened(address)
    page.evaluate(f"{PLAYER}.seek(0)")
    page.wait_for_function(f"() => {PLAYER}.time > 0.02 * {PLAYER}.whole")
    page.get_by_role("button", name="Pause").click()
    stood = page.evaluate(f"{PLAYER}.time")
    page.wait_for_timeout(200)
    assert page.evaluate(f"{PLAYER}.time") == stood
    page.get_by_label("time", exact=True).fill("500")
    assert page.evaluate(f"{PLAYER}.time / {PLAYER}.whole") == pytest.approx(0.5)


def test_who_wants_less_motion_gets_a_picture_at_rest(opened: Any, address: str) -> None:
    page = opened(address, reduced_motion="reduce")
    assert not page.evaluate(f"{PLAYER}.playing")
    page.wait_for_timeout(150)
    assert page.evaluate(f"{PLAYER}.time") == 0
    page.get_by_role("button", name="Play").click()
    page.wait_for_function(f"() => {PLAYER}.time > 0")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_fits_a_telephone(opened: Any, address: str, scheme: str) -> None:
    page = opened(address, color_scheme=scheme)
    page.set_viewport_size({"width": 390, "height": 800})
    page.wait_for_timeout(100)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert page.evaluate(f"{PLAYER}.theme") == scheme


def test_tubes_are_coloured_by_their_stress(opened: Any, tmp_path: Path) -> None:
    """τ = 16 T D/(π(D⁴ − d⁴)), blue against the twist, vermilion with it; without a section there is none."""
    wide, slim = (0.08, 0.06), (0.05, 0.0)
    tubes = [
        tn.Shaft(outer_diameter=outer, inner_diameter=inner, length=1.0, material="steel", damping=2.0, name=name)
        for name, (outer, inner) in {"wide": wide, "slim": slim}.items()
    ]
    first = tn.Disk(inertia=0.3, excitation=[{"order": 2, "amplitude": 50.0}])
    second = tn.Disk(inertia=0.2, excitation=[{"order": 3, "amplitude": 80.0}])
    plain = tn.Shaft(stiffness=3e3, name="plain")
    line = tn.Driveline([tn.ConstantSpeed(), tubes[0], first, tubes[1], second, plain, tn.Disk(inertia=0.1)])
    shown = tn.animate(line, "response", speed=60.0)
    page = opened(shown.save(tmp_path / "stress.html").as_uri())
    (movement,) = shown.motions[0].movements
    per = np.array([16 * d / (np.pi * (d**4 - inner**4)) for d, inner in (wide, slim)])
    stress = movement.torque[:, :2] * per
    page.evaluate(f"{PLAYER}.pause()")
    page.get_by_label("coloured by").select_option("stress")
    assert f"{np.abs(stress).max() / 1e6:.3g} MPa" in page.locator(".legend").inner_text()
    parts = [part.name for part in shown.motions[0].parts]
    for k in (7, 40, 63):
        page.evaluate(f"{PLAYER}.seek({movement.time[k] - movement.time[0]})")
        found = dict(zip(parts, page.evaluate(f"{PLAYER}.colours()"), strict=True))
        assert found["plain"] == ""
        for name, share in zip(("wide", "slim"), stress[k] / np.abs(stress).max(), strict=True):
            end = np.array([213, 94, 0]) if share > 0 else np.array([0, 114, 178])
            expected = 214 + abs(share) * (end - 214)
            seen = [int(found[name][i : i + 2], 16) for i in (0, 2, 4)]
            assert np.allclose(seen, expected, atol=1.5), (name, k)
    page.get_by_label("coloured by").select_option("torque")
    assert f"{np.abs(movement.torque).max():.3g} N m" in page.locator(".legend").inner_text()
    assert page.evaluate(f"{PLAYER}.colours()")[parts.index("plain")] != ""
