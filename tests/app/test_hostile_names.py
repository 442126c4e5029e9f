"""No name, text or file runs a script: in any view, in the report, in what is saved; in a real browser as well."""

from __future__ import annotations

import ast
import re
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import pytest

pytest.importorskip("panel")

import hostile
from served import Look
from test_exported_code import view_of

import trunnion as tn
from trunnion.app.address import pack
from trunnion.app.page import Page
from trunnion.app.parts.calls import script
from trunnion.app.parts.document import Document
from trunnion.app.parts.variant_strip import KeptVariant, VariantStrip
from trunnion.app.parts.variants import difference
from trunnion.app.parts.widgets import HtmlPane, lines, markup, small
from trunnion.app.views.base import View, links
from trunnion.app.worker import WorkerLoop
from trunnion.errors import TrunnionError

TOML = tn.dumps(hostile.line())
TAGS = {"p", "div", "span", "table", "tr", "th", "td", "ul", "li", "pre", "b", "h2", "a", "img"}
"""All that a page of the application is made of."""
SMALL = {"across": "4", "up": "3"}
QUESTIONS = [
    ("dashboard", {}),
    ("live", {"what": "mode"}),
    ("driveline", {}),
    ("verdict", {}),
    ("joints", {}),
    ("motion", {}),
    pytest.param("orders", {}, marks=pytest.mark.slow),
    ("limits", {"what": "errors of assembly"}),
    pytest.param("stability", SMALL, marks=pytest.mark.slow),
    pytest.param("limits", {"speeds": "2", "high": "20"}, marks=pytest.mark.slow),
    pytest.param("limits", {"what": "stable windows of a parameter", "high": "20"}, marks=pytest.mark.slow),
    pytest.param("limits", {"what": "tolerances"}, marks=pytest.mark.slow),
    pytest.param("limits", {"what": "what the checks follow most"}, marks=pytest.mark.slow),
    pytest.param("limits", {"what": "best value of a parameter", "aim": "irregularity"}, marks=pytest.mark.slow),
    pytest.param("motion", {"what": "run-up", "rate": "400"}, marks=pytest.mark.slow),
    pytest.param("motion", {"what": "section", "returns": "20"}, marks=pytest.mark.slow),
]


def harmless(page: str) -> hostile.Tags:
    """A piece of a page that holds no tag but the application's own, and nothing that could run."""
    found = hostile.Tags(page)
    assert found.tags <= TAGS
    assert found.running == []
    return found


def sent(panel: Any) -> str:
    """What the browser gets of everything in a panel that is HTML, unescaped as it does."""
    from html import unescape

    return "\n".join(unescape(one._transform_object(one.object)["object"]) for one in panel.select(HtmlPane))


def shown(view: View) -> str:
    """What a view shows of its line once everything is computed."""
    worker = WorkerLoop(BytesIO(), BytesIO(), 1)
    side, document = view.of("now"), view.session.document
    for step in view.steps(document.line):
        try:
            data = worker.compute(step.job(document.toml), lambda share: None)
        except TrunnionError as error:
            assert step.soft, error
            side.refused(step, str(error))
        else:
            side.show(step, data)
    return sent(side.panel) + sent(view.controls) + links("token", view, document.line)


def test_what_looks_for_harm_finds_it() -> None:
    for name in ("<img src=x onerror=ran(1)>", "<script>ran(1)</script>", "<a href=javascript:ran(1)>a</a>"):
        with pytest.raises(AssertionError):
            harmless(name)


@pytest.mark.parametrize(("name", "settings"), QUESTIONS)
def test_every_view_shows_names_as_text(name: str, settings: dict[str, str]) -> None:
    found = harmless(shown(view_of(TOML, name, settings)))
    if name in ("verdict", "joints", "motion"):
        assert any(one in found.text for one in hostile.NAMES)


@pytest.mark.parametrize("text", hostile.NAMES)
def test_every_message_and_piece_shows_text_as_text(text: str) -> None:
    page = Page({"Driveline": "driveline"}, "driveline", lambda name: None, lambda: None)
    page.message(f"{text}\n{text}")
    page.idle(text, (text,))
    kept = tn.dumps(tn.loads(TOML).replace("load", load_torque=1.0)) if "load" in tn.loads(TOML).names else TOML
    pieces = (
        sent(page.status), small(text, data_x=text), lines(f"{text}\n{text}"), markup("<p>{0:s}</p>", text),
        difference(text, kept, tn.Driveline(hostile.line().elements, name=text)),
    )  # fmt: skip
    strip = VariantStrip(SimpleNamespace())  # type: ignore[arg-type]
    strip.show([KeptVariant("kept 1", text, TOML, TOML, verdict=markup("{}", text))], markup("{}", text))
    assert harmless(sent(strip.panel)).text
    for piece in pieces:
        assert text in " ".join(harmless(piece).text.split("\n")) or piece is pieces[-1]
    plain = HtmlPane(text)
    assert harmless(sent(plain)).text == text


def test_a_refusal_of_a_file_is_shown_as_text() -> None:
    """Keys, values and tables of a file that cannot be read are quoted in its refusal."""
    page = Page({"Driveline": "driveline"}, "driveline", lambda name: None, lambda: None)
    for name in hostile.NAMES:
        quoted = "'" + name.replace("'", "") + "'"
        for text in (f"{quoted} = 1\n", f"format = 1\n[[element]]\ntype = {quoted}\n", f"format = {quoted}\n"):
            with pytest.raises(TrunnionError) as refusal:
                Document(text)
            page.message(str(refusal.value))
            harmless(sent(page.status))


def no_script_in(svg: bytes) -> None:
    """Elements, attributes and links of an SVG, read as the XML that it is."""
    for node in ElementTree.fromstring(svg).iter():
        assert not str(node.tag).endswith(("script", "foreignObject", "handler"))
        for key, value in node.attrib.items():
            assert not key.lower().startswith("on") and "javascript:" not in value.lower()


@pytest.mark.parametrize(
    ("view", "settings"),
    [
        ("joints", {}),
        pytest.param("orders", {}, marks=pytest.mark.slow),
        pytest.param("stability", SMALL, marks=pytest.mark.slow),
    ],
)
def test_saved_pictures_hold_no_script(view: str, settings: dict[str, str]) -> None:
    there, worker = view_of(TOML, view, settings), WorkerLoop(BytesIO(), BytesIO(), 1)
    steps = [step for step in there.steps(there.session.document.line) if "svg" in step.endings]
    assert steps
    for step in steps:
        no_script_in(worker.compute(step.file(TOML, "svg"), lambda share: None))


@pytest.mark.parametrize("name", [*hostile.NAMES, '"""\nran(43)\n"""', "\\", '"', "a\\'''", "\u2028ran(44)"])
def test_saved_python_holds_names_as_strings(name: str) -> None:
    """Whatever it says, the program is as long as with a harmless name and calls nothing else."""

    def calls(title: str) -> list[str]:
        line = tn.Driveline(hostile.line().elements, name=title.strip().replace("\n", " ").replace("\u2028", " "))
        toml = tn.dumps(line)
        view = view_of(toml, "orders", {})
        steps = {s.name: (s.call, s.toml(toml)) for s in view.steps(line)}
        tree = ast.parse(script(toml, steps, f"Orders of {title}"))
        return [ast.unparse(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)]

    assert calls(name) == calls("a name")


def test_all_html_is_made_by_the_function_that_escapes() -> None:
    """No other file makes panes of HTML or marks text as HTML, and no template holds anything but words of the program.

    Templates are constants, or names of constants; every tag in the application stands in one.
    """
    folder = Path(tn.__file__).parent / "app"
    others = re.compile(
        r"pn\.pane\.(HTML|Markdown|Str|Alert)|pn\.widgets\.(StaticText|TooltipIcon)|\bDiv\(|PreText|Html\([^)]"
    )
    templates = 0
    for path in sorted(folder.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if path.name != "widgets.py":
            assert not others.search(text), path
        tree = ast.parse(text)
        constants = {
            target.id: node.value
            for node in ast.walk(tree)
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant)
            for target in node.targets
            if isinstance(target, ast.Name)
        }
        allowed: set[int] = set()
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "markup":
                first = node.args[0]
                constant = constants.get(first.id) if isinstance(first, ast.Name) else first
                assert isinstance(constant, ast.Constant), (path, node.lineno)
                allowed.add(id(constant))
                templates += 1
        for node in ast.walk(tree):
            written = isinstance(node, ast.JoinedStr) and re.search(r"</?[a-z]+[ >]", ast.unparse(node))
            assert not written, (path, node.lineno)
    assert templates > 20


RAN = """() => {
  window.hits = []; window.ran = k => window.hits.push(k); window.name = ''
  document.addEventListener('securitypolicyviolation', e => window.hits.push(e.violatedDirective + ' ' + e.sourceFile))
}"""
VIEWS = (
    ("Driveline", "img[alt^='sketch']"),
    ("Dashboard", "[data-value=growth]"),
    ("Live", "canvas.view"),
    ("Parts", "table.checks"),
    ("Verdict", "[data-verdict]"),
    ("Orders", ".bk-Canvas"),
    ("Joints", "img[alt^='joints and forks']"),
    ("Limits", "pre"),
    ("Motion", "pre"),
    ("Stability", "[data-chart='chart']"),
)


def hits(look: Look) -> list[str]:
    return list(look.page.evaluate("() => window.hits"))


def test_no_view_in_a_browser_runs_a_name(look: Look, tmp_path: Path) -> None:
    """Opened by an address, walked through and hovered over; nor does what a refusal quotes of a field or of a file."""
    look.page.add_init_script(f"({RAN})()")
    dialogs: list[str] = []
    look.page.on("dialog", lambda dialog: (dialogs.append(dialog.message), dialog.dismiss()))
    settings = "limits.what=errors+of+assembly&stability.across=4&stability.up=3"
    look.page.goto(f"{look.server.address}?view=driveline&{settings}&line={pack(TOML)}")
    for view, shows in VIEWS:
        look.view(view)
        look.page.locator(shows).first.wait_for()
        for canvas in look.page.locator(".bk-Canvas").all()[:2]:
            if box := canvas.bounding_box():
                for k in range(6):
                    look.page.mouse.move(box["x"] + box["width"] * (k + 1) / 7, box["y"] + box["height"] * (k + 2) / 9)
        assert hits(look) == [], view
    look.view("Driveline")
    field = look.page.get_by_label(re.compile("^stiffness of "), exact=False).first
    field.fill("12 <img src=x onerror=ran(0)>")
    field.press("Enter")
    look.page.get_by_text("<img src=x onerror=ran(0)>").first.wait_for()
    look.page.get_by_label("Open a TOML file").set_input_files(
        {
            "name": "<img src=x onerror=ran(0)>.toml",
            "mimeType": "text/plain",
            "buffer": b"'<img src=x onerror=ran(0)>' = 1",
        }
    )
    look.page.get_by_role("alert").get_by_text("onerror=ran(0)").first.wait_for()
    assert (hits(look), dialogs) == ([], [])
    look.page.evaluate("() => { document.body.innerHTML += '<img src=x onerror=ran(0)>' }")
    look.page.wait_for_function("() => window.hits.length > 0")
    assert "script-src" in hits(look)[0]  # what runs is noticed, and the policy does not let it


@pytest.mark.slow
def test_the_report_holds_no_script_and_runs_none_in_a_browser(browser: Any, tmp_path: Path) -> None:
    made = tn.report(hostile.line(), points=(3, 3))
    found = hostile.Tags(made.html)
    assert "script" not in found.tags and found.running == []
    assert sum(name in found.text for name in hostile.NAMES) > 20
    for picture in made.pictures.values():
        assert picture.figure is not None
        drawn = BytesIO()
        picture.figure.savefig(drawn, format="svg")
        no_script_in(drawn.getvalue())
    path = made.save(tmp_path / "report.html")
    context = browser.new_context()
    page = context.new_page()
    page.add_init_script(f"({RAN})()")
    dialogs: list[str] = []
    page.on("dialog", lambda dialog: (dialogs.append(dialog.message), dialog.dismiss()))
    page.goto(path.as_uri())
    page.wait_for_timeout(300)
    assert (page.evaluate("() => window.hits"), dialogs) == ([], [])
    assert page.locator("h1").inner_text().strip() == " ".join((hostile.line().name or "").split())
    context.close()
