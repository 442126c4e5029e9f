"""The dashboard: all of it on one screen, numbers of the public functions, no verdict but that of the line shown."""

from __future__ import annotations

import pytest
from served import Look

import trunnion as tn
from trunnion.app import shown
from trunnion.driveline.starter import starter

DEEP = """const deep = (root, css) => [...root.querySelectorAll('*')].flatMap(e =>
  [...(e.matches(css) ? [e] : []), ...(e.shadowRoot ? deep(e.shadowRoot, css) : [])])"""


def test_a_fresh_page_begins_with_it_on_one_screen(look: Look) -> None:
    look.page.set_viewport_size({"width": 1440, "height": 900})
    look.at("")
    look.page.set_default_timeout(40_000)
    page, line = look.page, tn.loads(starter("two-shaft"))
    verdict = tn.assess(line)
    page.get_by_text(verdict.sentence, exact=True).wait_for()
    growth = tn.stability(line).growth_rate
    assert f"by {abs(growth):.4g} 1/s" in page.locator("[data-value=growth]").inner_text()
    titles = ("The line", "Verdict", "Stability", "Critical speeds", "The shaft loaded most", "Campbell diagram")
    for title in titles:
        box = page.get_by_role("button", name=f"{title} ›").bounding_box()
        assert box and box["y"] + box["height"] < 900, title
    bottoms = "deep(document, 'canvas').map(c => c.getBoundingClientRect().bottom)"
    ends = page.evaluate(f"(() => {{ {DEEP}; return {bottoms} }})()")
    assert ends and max(ends) <= 900
    page.get_by_role("button", name="Critical speeds ›").click()
    page.wait_for_url("**view=orders**")


@pytest.mark.slow
def test_no_verdict_stands_beside_another_line(look: Look) -> None:
    """From the moment that a number moves until the whole search has ended the verdict is not yet checked."""
    look.at("?view=dashboard")
    page = look.page
    page.set_default_timeout(40_000)
    before = tn.assess(tn.loads(starter("two-shaft")))
    page.get_by_text(before.sentence, exact=True).wait_for()
    page.evaluate(
        f"""() => {{ {DEEP}; window.seen = []
        const look = () => {{ const now = deep(document, '[data-verdict]').map(e => e.innerText).join('|')
          if (now && window.seen.at(-1) !== now) window.seen.push(now)
          window.timer = setTimeout(look, 4) }}
        look() }}"""
    )
    label = page.get_by_label("Parameter to move", exact=True).input_value()
    number = page.get_by_label("Value [deg]", exact=True)
    assert label.endswith(".angle")
    changed = tn.loads(starter("two-shaft")).replace(label.removesuffix(".angle"), angle="1.5 deg")
    number.fill("1.5")
    number.press("Enter")
    after = tn.assess(changed)
    assert after.sentence != before.sentence
    page.get_by_text(after.sentence, exact=True).wait_for()
    seen = page.evaluate("(() => { clearTimeout(window.timer); return window.seen })()")
    assert seen[0] == before.sentence
    assert seen[1] == "not yet checked"
    assert seen[-1] == after.sentence
    assert set(seen[1:-1]) == {"not yet checked"}


def test_what_tiles_say_is_what_was_computed() -> None:
    line = tn.load("examples/truck.toml")
    found = shown.near(tn.resonance_speeds(line), "rpm", tn.rpm(1200))
    able = sorted(r.speed for r in tn.resonance_speeds(line) if r.opens)
    above = min(v for v in able if v > tn.rpm(1200))
    away = f"{100 * (above / tn.rpm(1200) - 1):.2g} % above"
    assert any(f"can begin at {above / tn.rpm(1):.4g} rpm, {away}" in said for said in found)
    straight = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e3), tn.Disk(inertia=1.0)])
    assert "can begin" in shown.near(tn.resonance_speeds(straight), "rpm", 10.0)[0]
    response = tn.order_response(line, tn.sweep_speeds(line, tn.rpm(300), tn.rpm(2400)))
    worst = shown.worst(response, "rpm")["said"]
    shares = {
        name: response.peak_torque[:, k].max() / limit
        for k, name in enumerate(response.springs)
        if (limit := response.limits[name].get("max torque"))
    }
    assert worst.startswith(max(shares, key=lambda name: shares[name]) if shares else "")


@pytest.mark.slow
@pytest.mark.parametrize("width", [390, 1024, 1920])
def test_it_needs_no_sideways_scroll(look: Look, width: int) -> None:
    look.page.set_viewport_size({"width": width, "height": 900})
    look.at("?view=dashboard")
    assert look.page.evaluate("document.documentElement.scrollWidth") <= width
