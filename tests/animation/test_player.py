"""The player is what stands beside it: built from these sources with the stated versions, its licence with it; pages of
it are plain, their only script admitted by hash."""

from __future__ import annotations

import hashlib
import json
import re
from base64 import b64encode
from html.parser import HTMLParser
from pathlib import Path

import pytest

import trunnion as tn
from trunnion.animation.page import MODULE, PLAYER
from trunnion.errors import InputError

FOLDER = PLAYER.parent
HOSTILE = '</script><img src=x onerror="window.hacked=1">'


def test_the_player_is_built_from_these_sources() -> None:
    """Where it fails: npm ci && npm run build in the folder of the player."""
    digest = hashlib.sha256()
    for path in [FOLDER / "package-lock.json", FOLDER / "build.mjs", *sorted((FOLDER / "source").iterdir())]:
        digest.update(path.read_bytes())
    head = PLAYER.read_text(encoding="ascii")[:400]
    assert f"sha256-{digest.hexdigest()}" in head
    lock = json.loads((FOLDER / "package-lock.json").read_text(encoding="utf-8"))["packages"]
    asked = json.loads((FOLDER / "package.json").read_text(encoding="utf-8"))
    for name, kind in (("three", "dependencies"), ("esbuild", "devDependencies")):
        assert lock[f"node_modules/{name}"]["version"] == asked[kind][name]
        assert f"{asked[kind][name]} " in head


def test_its_licence_stands_beside_it() -> None:
    assert "MIT" in (FOLDER / "LICENSE-three.txt").read_text(encoding="utf-8")
    assert "LICENSE-three.txt" in PLAYER.read_text(encoding="ascii")[:400]


def test_it_ends_no_script_and_imports_nothing() -> None:
    script = PLAYER.read_text(encoding="ascii").partition(MODULE)[0]
    assert "</" not in script
    assert "<!--" not in script
    assert not re.search(r"\bimport\s*\(|\bimport\s+[\w{*\"']|\beval\(|new Function\(", script)


class Scripts(HTMLParser):
    """What a page holds between the tags of its scripts, and every attribute that would run or fetch something."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[dict[str, str | None], str]] = []
        self.bad: list[str] = []
        self.within = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.within = tag == "script"
        if self.within:
            self.found.append((dict(attrs), ""))
        self.bad += [f"{tag} {key}" for key, _ in attrs if key.startswith("on") or key in ("src", "href")]

    def handle_endtag(self, tag: str) -> None:
        self.within = False

    def handle_data(self, data: str) -> None:
        if self.within:
            attributes, text = self.found[-1]
            self.found[-1] = attributes, text + data


def hostile() -> tn.Driveline:
    shaft = tn.Shaft(stiffness=1e3, damping=1.0, name=HOSTILE)
    return tn.Driveline([tn.ConstantSpeed(), shaft, tn.Disk(inertia=0.1)], name=HOSTILE)


def test_a_page_admits_its_one_script_and_holds_names_as_text() -> None:
    page = tn.animate(hostile(), "mode").html
    seen = Scripts()
    seen.feed(page)
    assert seen.bad == []
    (kind, data), (_, script) = seen.found
    assert kind["type"] == "application/json"
    assert json.loads(data)["title"] == HOSTILE
    assert b64encode(hashlib.sha256(script.encode()).digest()).decode() in page
    assert "default-src 'none'" in page
    assert 'onerror="' not in page.replace(script, "")


def test_files_are_by_their_ending(tmp_path: Path) -> None:
    animation = tn.animate(hostile(), "mode")
    data = json.loads(animation.save(tmp_path / "line.json").read_text())
    assert data["choices"][0]["parts"][1]["name"] == HOSTILE
    from PIL import Image

    with Image.open(animation.save(tmp_path / "line.gif", seconds=0.5, width=200)) as picture:
        assert picture.n_frames == 10
        frames = []
        for k in range(picture.n_frames):
            picture.seek(k)
            frames.append(picture.convert("RGB").tobytes())
    assert len(set(frames)) > 4  # a cosine passes most places twice
    with pytest.raises(InputError, match=r"end it in one of \.html, \.gif, \.json"):
        animation.save(tmp_path / "line.mp4")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["line.gif", "line.json"]


def test_a_notebook_shows_the_page() -> None:
    shown = tn.animate(hostile(), "mode")._repr_html_()
    assert shown.startswith("<iframe srcdoc=")
    assert "<script" not in shown
