"""The command ``animate``, and the page that ``analyze --live`` writes."""

from __future__ import annotations

import json

import pytest

import trunnion as tn


def test_animate_writes_a_page(run, here):
    result = run("animate", "line.toml", "--what", "mode", "--mode", 2)
    assert result.exit_code == 0, result.stderr
    frequency = tn.natural_frequencies(tn.load("line.toml")).undamped_frequency[1] / 6.283185307179586
    assert f"Mode 2 of the straight line: {frequency:.6g} Hz" in result.stdout
    page = (here / "trunnion-out" / "line-animate.html").read_text(encoding="utf-8")
    assert "trunnion-scene" in page and "https://" not in page.partition('id="trunnion-scene"')[0]


def test_animate_writes_what_is_named(run, here):
    result = run("animate", "line.toml", "--speed", "900 rpm", "-o", "a.json", "-o", "b.gif", "--json")
    assert result.exit_code == 0, result.stderr
    said = json.loads(result.stdout)
    assert said["written"] == ["a.json", "b.gif"]
    assert said["motions"][0]["movements"][0]["seconds"] == pytest.approx(2 * 3.141592653589793 / tn.rpm(900))
    scene = json.loads((here / "a.json").read_text(encoding="utf-8"))
    assert scene["choices"][0]["movements"][0]["end"] == pytest.approx(said["motions"][0]["movements"][0]["seconds"])
    assert (here / "b.gif").read_bytes()[:6] == b"GIF89a"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--what", "mod"), 'did you mean "mode"?'),
        (("-o", "a.mp4"), "end it in one of .html, .gif, .json"),
        (("-o", "no/a.html"), "lies in no folder"),
        (("--what", "mode", "--speed", "900 rpm"), "does not belong to mode"),
    ],
)
def test_animate_refuses(run, here, arguments, words):
    result = run("animate", "line.toml", *arguments)
    assert result.exit_code == 2
    assert words in result.stderr
    assert not list(here.glob("trunnion-out/*"))


def test_analyze_live_writes_a_page_beside_the_report(run, here):
    text = (here / "line.toml").read_text(encoding="utf-8")
    (here / "line.toml").write_text(text.replace('angle = "12 deg"', 'angle = "1 deg"'), encoding="utf-8")
    result = run("analyze", "line.toml", "--points", "12x6", "--live", "-o", "page.html")
    assert result.exit_code == 0, result.stderr
    assert "page-live.html" in result.stdout
    assert "<script" not in (here / "page.html").read_text(encoding="utf-8")
    page = (here / "page-live.html").read_text(encoding="utf-8")
    data = json.loads(page.partition('id="trunnion-scene">')[2].partition("</script>")[0])
    titles = [one["title"] for one in data["choices"]]
    assert titles == ["turning", "mode 1", "mode 2", "response", "disturbance"]
