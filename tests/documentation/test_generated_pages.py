"""Pages that the package writes about itself: every element, key and name is there, and their files are read."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from as_printed import ROOT
from generate import api, changelog, commands, elements, examples, player

import trunnion as tn
from trunnion.driveline.kinds import KINDS


@pytest.mark.filterwarnings("ignore::trunnion.InputRemark")
@pytest.mark.parametrize("kind", KINDS)
def test_an_element_has_a_file_that_is_read(kind: str) -> None:
    text = examples.example(kind)
    assert kind in [one["type"] for one in tomllib.loads(text)["element"]]
    assert any(type(one).__name__ == kind for one in tn.loads(text).as_stated.elements)


@pytest.mark.parametrize("kind", sorted(elements.schema()["$defs"]))
def test_every_key_has_a_meaning(kind: str) -> None:
    model = elements.schema()["$defs"][kind]
    for name, key in model["properties"].items():
        assert name == "type" or key.get("description"), f"{kind}.{name}"
    page = elements.keys(model)
    assert all(f"`{name}`" in page for name in model["properties"])


def test_units_are_si_and_defaults_are_told() -> None:
    shaft = elements.keys(elements.schema()["$defs"]["Shaft"])
    assert re.search(r"`stiffness` \| torsional stiffness \| N m/rad \|", shaft)
    assert re.search(r"`damping` \| viscous damping \| N m s/rad \| `0.0`", shaft)
    joint = elements.keys(elements.schema()["$defs"]["HookeJoint"])
    assert re.search(r"`angle` \|[^|]*\| rad \| \*\*needed\*\*", joint)


def test_commands_are_printed_as_they_are_typed(tmp_path: Path) -> None:
    """Nothing outside code holds two hyphens, which typography would make a dash; examples are lines to copy."""
    commands.write_page(tmp_path / "commands.md")
    page = (tmp_path / "commands.md").read_text(encoding="utf-8")
    prose = re.sub(r"`[^`]*`", "", re.sub(r"```sh\n.*?```", "", page, flags=re.S))
    assert not re.search(r"--[a-z]", prose) and "Example" not in prose
    lines = re.findall(r"^trunnion .*$", page, re.M)
    assert "trunnion assess truck.toml --load-case climb --remedies" in lines
    assert "trunnion study show truck.zarr" in lines and "trunnion study truck-study.toml" in lines
    assert len(lines) == page.count("\ntrunnion ") >= 30
    assert "smartquotes = False" in (ROOT / "docs/conf.py").read_text(encoding="utf-8")


@pytest.mark.slow
def test_every_public_name_has_an_entry(tmp_path: Path) -> None:
    api.write_pages(tmp_path)
    pages = "\n".join(path.read_text(encoding="utf-8") for path in tmp_path.glob("*.md"))
    for name in tn.__all__:
        assert name == "__version__" or f"(tn-{name.lower()})=" in pages, name
    for name in re.findall(r"\(#result-(\w+)\)", pages):
        assert f"(result-{name})=" in pages


def test_the_home_page_plays_a_line_and_prints_a_picture() -> None:
    page = (ROOT / "docs/index.md").read_text(encoding="utf-8")
    shown = player.embedded(page)
    assert f'src="_static/{player.FILE}"' in shown
    assert (
        shown.index("<iframe") < shown.index("home-on-paper") < shown.index(player.PICTURE) < shown.index("home-pair")
    )
    assert shown.startswith(page[: page.index("![")]) and shown.endswith(page[page.index("::::{container}") :])


def test_the_line_on_the_home_page_is_that_of_its_verdict(tmp_path: Path) -> None:
    """It fetches nothing, and turns where the verdict that stands below it binds."""
    player.write_page(tmp_path / player.FILE)
    page = (tmp_path / player.FILE).read_text(encoding="utf-8")
    assert "power take-off shaft of a mulcher" in page and "://" not in re.sub(
        r"<script>.*</script>", "", page, flags=re.S
    )
    home = (ROOT / "docs/index.md").read_text(encoding="utf-8")
    assert f"at {player.SPEED}, " in home and f"analyze {player.LINE}" in home


def test_links_to_files_at_the_top_lead_to_their_pages_and_others_name_the_file() -> None:
    docs = ROOT / "docs"
    assert changelog.leaving("see [README](../README.md#start)", docs) == "see [README](generated/readme.md#start)"
    assert changelog.leaving("a [recipe](../.ci/release) and [signs](conventions.md)", docs) == (
        "a recipe (`.ci/release`) and [signs](conventions.md)"
    )
    text = "![A verdict](docs/images/verdict.png), [MIT](LICENSE), [how](docs/how-do-i.md#x), [out](https://a.example)"
    assert changelog.turned(text, ROOT, "../") == (
        "![A verdict](../images/verdict.png), MIT (`LICENSE`), [how](../how-do-i.md#x), [out](https://a.example)"
    )
