"""A measured file in the application: what is taken, what is refused, that nothing of it stays, and what is shown."""

from __future__ import annotations

import ast
import gc
import os
import tempfile
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.io import wavfile
from served import IDLE, Look, Server, start_server

import trunnion as tn
from trunnion.app import shown
from trunnion.app.parts import calls, received
from trunnion.app.parts.calls import script
from trunnion.app.parts.received import CHUNK, MOST_BYTES, ReceivedFile
from trunnion.app.worker import WorkerLoop
from trunnion.errors import InputError

pytest.importorskip("panel")

LINE = tn.Driveline(
    [
        tn.ConstantSpeed(),
        tn.HookeJoint(angle="12 deg", name="joint"),
        tn.Shaft(stiffness=2e4, damping=25.0, name="tube"),
        tn.Disk(inertia=0.5, name="hub"),
    ]
)
WHEELS = [
    {"column": place, "name": place, "kind": "edges", "pulses_per_turn": 30, "at": place} for place in ("input", "hub")
]
TOML = "\n".join(
    "[[channel]]\n" + "\n".join(f'{k} = "{v}"' if isinstance(v, str) else f"{k} = {v}" for k, v in one.items())
    for one in WHEELS
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where temporary files go, watched."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def left_in(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if path.name.startswith("trunnion-") or path.name.startswith("signals")]


def edges() -> bytes:
    """Edges of two wheels on a run-up, as a table."""
    run = tn.measure(LINE, (60.0, 200.0), 6.0, {"input": 30, "hub": 30}, jitter=1e-6, pitch_error=0.0)
    first, second = (train.times for train in run.pulses)
    rows = min(len(first), len(second))
    return (
        b"input,hub\n"
        + "\n".join(f"{a:.9f},{b:.9f}" for a, b in zip(first[:rows], second[:rows], strict=True)).encode()
    )


def sent(content: bytes, name: str = "run.csv") -> ReceivedFile:
    file = ReceivedFile(name, len(content))
    for place in range(0, len(content), CHUNK):
        file.take(place, content[place : place + CHUNK])
    return file


NAMES = (
    ("../../etc/passwd.csv", "passwd.csv"),
    ("C:\\Users\\me\\run.csv", "run.csv"),
    ("<img src=x onerror=alert(1)>.csv", "<img src=x onerror=alert(1)>.csv"),
    ("a'; import os #.wav", "a'; import os #.wav"),
    ("CON.csv", "CON.csv"),
    (".csv.csv", ".csv.csv"),
    ("Messung Prüfstand Ω 2.mf4", "Messung Prüfstand Ω 2.mf4"),
)


@pytest.mark.parametrize(("given", "kept"), NAMES)
def test_a_name_is_never_a_path(folder: Path, given: str, kept: str) -> None:
    file = ReceivedFile(given, 3)
    assert file.name == kept
    assert file.path.parent.parent == folder and file.path.stem == "signals"
    assert file.path.suffix == Path(kept).suffix.lower()
    file.close()
    assert left_in(folder) == []


REFUSED_FILES = (
    ("run.exe", 10, "is not a file of signals"),
    ("run", 10, "is not a file of signals"),
    (".csv", 10, "is not a file of signals"),
    ("", 10, "has no name that can be shown"),
    ("/", 10, "has no name that can be shown"),
    (None, 10, "has no name that can be shown"),
    (["a.csv"], 10, "has no name that can be shown"),
    ("a\nb.csv", 10, "has no name that can be shown"),
    ("\u202eexe.csv", 10, "has no name that can be shown"),
    ("a" * 300 + ".csv", 10, "has no name that can be shown"),
    ("run.csv", 0, "is empty"),
    ("run.csv", -1, "has more than"),
    ("run.csv", True, "has more than"),
    ("run.csv", 2.5, "has more than"),
    ("run.csv", "10", "has more than"),
    ("run.csv", MOST_BYTES + 1, "has more than the 2000 MB"),
)


@pytest.mark.parametrize(("name", "size", "said"), REFUSED_FILES)
def test_files_that_are_refused_leave_nothing(folder: Path, name: Any, size: Any, said: str) -> None:
    with pytest.raises(InputError) as caught:
        ReceivedFile(name, size)
    assert said in str(caught.value) and "\n" not in str(caught.value)
    assert left_in(folder) == []


REFUSED_CHUNKS = (
    (1, b"abc", "in order"),
    (None, b"abc", "in order"),
    ("0", b"abc", "in order"),
    (0, "abc", "in order"),
    (0, None, "in order"),
    (0, [1, 2], "in order"),
    (0, b"", "as long as"),
    (0, b"abcdef", "as long as"),
    (0, b"x" * (CHUNK + 1), "as long as"),
)


@pytest.mark.parametrize(("place", "chunk", "said"), REFUSED_CHUNKS)
def test_chunks_that_do_not_fit_delete_what_came(folder: Path, place: Any, chunk: Any, said: str) -> None:
    file = ReceivedFile("run.csv", 5)
    with pytest.raises(InputError) as caught:
        file.take(place, chunk)
    assert said in str(caught.value) and left_in(folder) == []
    with pytest.raises(InputError):
        file.take(0, b"abc")


def test_a_disk_that_is_full(folder: Path) -> None:
    file = ReceivedFile("run.csv", 5)

    class Full:
        def write(self, chunk: bytes) -> None:
            raise OSError(28, "No space left on device")

        def close(self) -> None:
            pass

    assert file._stream is not None
    file._stream.close()
    file._stream = Full()  # type: ignore[assignment]
    with pytest.raises(InputError, match="No space left on device"):
        file.take(0, b"abc")
    assert left_in(folder) == []


def test_what_nobody_holds_any_more_is_deleted(folder: Path) -> None:
    """Also where nobody closed it, be it by an error."""
    file = sent(b"a,b\n1,2\n")
    assert file.path.read_bytes() == b"a,b\n1,2\n" and file.is_whole
    with pytest.warns(ResourceWarning):
        del file
        gc.collect()
    assert left_in(folder) == []


def test_a_file_comes_chunk_by_chunk(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(received, "CHUNK", 1000)
    content = os.urandom(3500)
    file = ReceivedFile("run.wav", len(content))
    for place in range(0, 3500, 1000):
        assert not file.is_whole
        file.take(place, content[place : place + 1000])
    assert file.is_whole and file.path.read_bytes() == content
    with pytest.raises(InputError):
        file.take(3500, b"more")


# -- the view --------------------------------------------------------------------------------------------------------


class Page:
    """What the view asks of its page."""

    def __init__(self) -> None:
        self.document = SimpleNamespace(line=LINE)
        self.looked, self.tasks, self.asked = 0, list[Any](), list[Any]()

    def line(self, side: str) -> tn.Driveline:
        return self.document.line

    def setting_chosen(self) -> None:
        self.looked += 1

    def beside(self, work: Any) -> None:
        self.tasks.append(work)

    def locked(self, action: Any) -> None:
        action()

    async def ask(self, call: Any, show: str, side: str, options: Any = None, *, says: bool = False) -> Any:
        return getattr(shown, show)(call.evaluate(LINE), **options)

    def run(self) -> None:
        """End what was begun beside."""
        while self.tasks:
            with pytest.raises(StopIteration):
                self.tasks.pop().send(None)


@pytest.fixture
def view(folder: Path) -> Any:
    from trunnion.app.views.measured import MeasuredView

    made = MeasuredView(Page())  # type: ignore[arg-type]
    made.heard = []
    made.drop._send_msg = made.heard.append
    made.of("now")
    yield made
    made.close()
    for work in made.session.tasks:
        work.close()
    assert left_in(folder) == []


def drop(view: Any, content: bytes, name: str = "run.csv", description: Any = None, number: int = 1) -> None:
    """As the browser sends a file."""
    head = {"what": "file", "number": number, "name": name, "size": len(content), "description": description}
    view.drop._handle_msg(head)
    for place in range(0, len(content), CHUNK):
        chunk = content[place : place + CHUNK]
        view.drop._handle_msg({"what": "chunk", "number": number, "place": place, "chunk": chunk})


def computed(view: Any) -> dict[str, Any]:
    loop = WorkerLoop(None, None, 1)  # type: ignore[arg-type]
    line = view.session.document.line
    return {step.name: loop.compute(step.job(tn.dumps(line)), lambda share: None) for step in view.steps(line)[:2]}


def test_a_file_with_its_description(view: Any, folder: Path) -> None:
    drop(view, edges(), description={"name": "run.channels.toml", "text": TOML})
    assert view.session.looked == 1 and "described by run.channels.toml" in view.state.object
    over, campbell, run_up = view.steps(LINE)
    assert [over.name, campbell.name, run_up.name] == ["over", "campbell", "run-up"]
    data = computed(view)
    assert any("of hub" in one and "as predicted" in one for one in data["over"]["said"])
    assert data["over"]["channels"] == ["input", "hub"] and data["over"]["torques"] == []
    view.of("now").show(over, data["over"])
    view.of("now").show(campbell, data["campbell"])
    assert "as predicted" in view.of("now").said.object
    assert view.widgets["channel"].options == ["the first that moves", "input", "hub"]
    with pytest.raises(InputError, match="no torque channel"):
        shown.measured_run_up(run_up.call.evaluate(LINE))
    program = script(tn.dumps(LINE), {"over": (over.call, tn.dumps(LINE))}, "a test")
    assert "tn.read_measurement('run.csv', {'channel': [{'column': 'input'" in program
    assert str(folder) not in program
    view._forget()
    assert view.steps(LINE) == [] and left_in(folder) == [] and view.of("now").said.object == ""


def test_a_line_that_moves_does_not_read_the_file_anew(view: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    drop(view, edges(), description={"name": "run.channels.toml", "text": TOML})
    read: list[Any] = []
    real = tn.read_measurement
    monkeypatch.setattr(calls.trunnion, "read_measurement", lambda *more: (read.append(more), real(*more))[1])
    first = computed(view)["over"]["said"]
    view.session.document.line = LINE.replace("tube", stiffness=1.5e4)
    second = computed(view)["over"]["said"]
    assert len(read) == 1 and first != second and any("later" in one for one in second)


def test_a_reference_run_takes_off_errors_of_teeth(view: Any, folder: Path) -> None:
    """Without it the order that they could hide is named; with it the order is the line's to a tenth of that."""

    def recorded(line: tn.Driveline, speeds: Any, seconds: float, seed: int) -> bytes:
        wheels = {"pitch_error": 0.02, "wheels": 7, "seed": seed, "jitter": 1e-6}
        trains = tn.measure(line, speeds, seconds, {"input": 30, "hub": 30}, **wheels).pulses
        rows = zip(*(one.times[: min(len(t.times) for t in trains)] for one in trains), strict=True)
        return b"input,hub\n" + "\n".join(f"{a:.9f},{b:.9f}" for a, b in rows).encode()

    small = LINE.replace("joint", angle="2 deg")
    run, still = recorded(small, (60.0, 90.0), 6.0, 1), recorded(LINE.replace("joint", angle=0.0), 80.0, 6.0, 2)
    view.session.document.line = small
    view.settings["orders"] = "2"
    described = {"name": "run.channels.toml", "text": TOML}
    drop(view, run, description=described)
    assert view.keep_still.visible
    plain = computed(view)["over"]
    assert any("order 2 may be the wheel's" in one and "reference run" in one for one in plain["findings"])
    drop(view, still, "still.csv", described, number=2)
    view._take_as_reference()
    assert view.steps(small) == [] and view.still_state.object.startswith("Reference run: still.csv")
    assert view.still_state.object.endswith("Drop the run.")
    drop(view, run, number=3)
    assert "taken off." in view.still_state.object and "Drop the run" not in view.still_state.object
    assert "its columns as in still.csv" in view.state.object and len(list(folder.glob("trunnion-*"))) == 2
    found = computed(view)["over"]
    assert not any("wheel's" in one for one in found["findings"])
    off = [view.steps(small)[0].call.evaluate(small).off[0, 1]]
    program = script(tn.dumps(small), {"over": (view.steps(small)[0].call, tn.dumps(small))}, "a test")
    assert "calibration=tn.pitch_errors(tn.read_measurement('still.csv', " in program and str(folder) not in program
    view._forget_reference()
    off.append(view.steps(small)[0].call.evaluate(small).off[0, 1])
    assert off[0] < 0.1 * off[1] and len(list(folder.glob("trunnion-*"))) == 1


def test_fields_stand_for_a_description(view: Any) -> None:
    drop(view, edges())
    assert view.steps(LINE) == []
    view.session.run()
    assert view.columns == ["input", "hub"] and [cells["at"].value for cells in view.cells] == ["input", "hub"]
    view._read_fields()
    assert "has no channel" in view.heard[-1]["words"] and view.heard[-1]["alarm"] and view.steps(LINE) == []
    for cells in view.cells:
        cells["kind"].value, cells["pulses"].value = "edges", 30
    view._read_fields()
    assert view.description == {"channel": [one | {"column": k} for k, one in enumerate(WHEELS, start=1)]}
    assert len(view.steps(LINE)) == 3 and len(view.table.objects) == 3


def test_another_file_takes_the_place_of_the_first(view: Any, folder: Path) -> None:
    content = edges()
    drop(view, content, description={"name": "a.toml", "text": TOML})
    first = view.file.path
    drop(view, content, "second.csv", number=2)
    assert not first.exists() and view.file.name == "second.csv" and view.description is None
    view.session.tasks.pop().close()
    # A description that comes later is of the file that is there.
    view.drop._handle_msg({"what": "description", "name": "b.toml", "text": TOML})
    assert len(view.steps(LINE)) == 3
    # A file that never ends is not kept beside it.
    view.drop._handle_msg({"what": "file", "number": 3, "name": "c.csv", "size": 9, "description": None})
    assert len(list(folder.glob("trunnion-*"))) == 2
    view.drop._handle_msg({"what": "stop"})
    assert len(list(folder.glob("trunnion-*"))) == 1


DESCRIPTIONS = (
    ({"name": "a.toml", "text": "channel = ["}, "is not TOML"),
    ({"name": "a.toml", "text": "a = " + "[" * 5000}, "is not TOML"),
    ({"name": "a.toml", "text": ""}, "has no channel"),
    ({"name": "a.toml", "text": "[[channel]]\ncolumn = 1979-05-27"}, "must be"),
    ({"name": "a.toml", "text": "[[channel]]\ncolumn = 1\nshell = 'rm'"}, "unknown key"),
    ({"name": "a.toml", "text": "x" * 1_000_001}, "is not a description"),
    ({"name": "a\x00.toml", "text": ""}, "has no name that can be shown"),
    ({"text": ""}, "is not a description"),
    (["a"], "is not a description"),
    ("a", "is not a description"),
)


@pytest.mark.parametrize(("stated", "said"), DESCRIPTIONS)
def test_descriptions_that_are_refused(view: Any, stated: Any, said: str) -> None:
    drop(view, b"input,hub\n1,2\n", description=stated)
    words = [one["words"] for one in view.heard if one.get("alarm")]
    assert len(words) == 1 and said in words[0] and "\n" not in words[0]
    assert view.steps(LINE) == []


MESSAGES = (
    None, "text", 3, [], {}, {"what": None}, {"what": "file"}, {"what": "chunk"}, {"what": "description"},
    {"what": "chunk", "number": 1, "place": 0, "chunk": b"a"}, {"what": "shell", "number": 1},
    {"what": "file", "number": "1", "name": "a.csv", "size": 3, "description": None},
    {"what": "file", "number": 1, "name": {"a": 1}, "size": 3, "description": None},
    {"what": "description", "name": "a.toml", "text": TOML},
)  # fmt: skip


@pytest.mark.parametrize("message", MESSAGES, ids=range(len(MESSAGES)))
def test_messages_that_no_page_sends(view: Any, folder: Path, message: Any) -> None:
    view.drop._handle_msg(message)
    assert view.file is None and view.steps(LINE) == [] and left_in(folder) == []


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("run.wav", b"RIFF" + b"\0" * 40), ("run.mat", b"MATLAB 5.0" + b"\xff" * 200),
        ("run.h5", b"\x89HDF\r\n\x1a\n" * 9), ("run.csv", b"\xff\xfe\x00"),
    ],
    ids=["wav", "mat", "h5", "csv"],
)  # fmt: skip
def test_damaged_files_are_said_by_their_own_names(view: Any, folder: Path, name: str, content: bytes) -> None:
    """And deleted."""
    drop(view, content, name)
    view.session.run()
    words = view.heard[-1]["words"]
    assert name in words and "signals." not in words and str(folder) not in words, words
    assert view.file is None and left_in(folder) == []


def test_a_name_is_a_text_in_programs_and_on_the_page(view: Any) -> None:
    name = "<img src=x onerror=alert(1)>'; import os #.csv"
    drop(view, edges(), name, description={"name": "<b>.toml", "text": TOML})
    step = view.steps(LINE)[0]
    program = ast.parse(script(tn.dumps(LINE), {"over": (step.call, tn.dumps(LINE))}, "a test"))
    assert [alias.name for node in ast.walk(program) if isinstance(node, ast.Import) for alias in node.names] == [
        "trunnion"
    ]
    assert any(isinstance(node, ast.Constant) and node.value == name for node in ast.walk(program))
    assert "<img" in view.state.object and "<img" not in str(view.state._transform_object(view.state.object))


def test_orders_that_are_no_numbers(view: Any) -> None:
    drop(view, edges(), description={"name": "a.toml", "text": TOML})
    view.settings["orders"] = "1, two"
    with pytest.raises(InputError, match="is not a list of orders"):
        view.steps(LINE)
    view.settings["orders"] = "1, 2"
    assert "(1.0, 2.0)" in view.steps(LINE)[0].call.text()


# -- in the browser --------------------------------------------------------------------------------------------------

FIGURES = "[...Bokeh.documents[0]._all_models.values()].filter(m => m.type === 'Figure').length"
ONTO = """async (zone, files) => {
  const transfer = new DataTransfer()
  for (const [name, size, text] of files) {
    const body = text ?? new Uint8Array(size)
    transfer.items.add(new File([body], name))
  }
  zone.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }))
}"""


@pytest.fixture
def server_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A server whose temporary files are looked at."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    tn.dump(LINE.replace("tube", stiffness=1.7e4), tmp_path / "line.toml")
    server = start_server(str(tmp_path / "line.toml"))
    yield server
    if server.process.poll() is None:
        server.stop()


def waves(path: Path) -> Path:
    """Two wheels and a gauge, sampled at 50 kHz: more than one message holds."""
    run = tn.measure(
        LINE, (60.0, 240.0), 20.0, {"input": 30, "hub": 30}, gauges=["tube"], gauge_rate=50e3, gauge_noise=0.5,
        jitter=2e-7, pitch_error=0.0,
    )  # fmt: skip
    t = np.arange(1_000_000) / 50e3
    signals = [np.sin(2 * np.pi * np.interp(t, one.times, np.arange(len(one.times)))) for one in run.pulses]
    torque = run.channel("tube").values[: len(t)]
    every = np.stack([*signals, torque / 2000.0], axis=1)
    wavfile.write(path, 50_000, (32_000 * every).astype(np.int16))
    assert path.stat().st_size > 4_000_000
    gauge = {"column": 3, "name": "gauge", "kind": "torque", "unit": "N*m", "scale": 2000.0 / 32_000, "at": "tube"}
    columns = [one | {"column": k, "kind": "pulses"} for k, one in enumerate(WHEELS, start=1)]
    path.with_suffix(".channels.toml").write_text(
        "\n".join(
            "[[channel]]\n" + "\n".join(f'{k} = "{v}"' if isinstance(v, str) else f"{k} = {v}" for k, v in one.items())
            for one in [*columns, gauge]
        )
    )
    return path


@pytest.mark.slow
def test_a_file_is_dropped_and_laid_over_the_line(tmp_path: Path, server_here: Server, browser: Any) -> None:
    path = waves(tmp_path / "run-up.wav")
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    page = context.new_page()
    page.set_default_timeout(180_000)
    look = Look(page, server_here)
    page.on("pageerror", lambda error: look.errors.append(str(error)))
    page.on("filechooser", lambda chooser: None)  # the browser takes a while until it hands the first chooser over
    look.at("?view=measured")
    # Chosen by keyboard: the field is reached by Tab and opened by Enter.
    field = page.get_by_label("Measured file")
    page.get_by_role("button", name="Measured", exact=True).or_(
        page.get_by_role("radio", name="Measured")
    ).first.focus()
    for _ in range(20):
        page.keyboard.press("Tab")
        if field.evaluate("node => node.getRootNode().activeElement === node"):
            break
    else:
        pytest.fail("the field is not reached by Tab")
    with page.expect_file_chooser() as chooser:
        page.keyboard.press("Enter")
    chooser.value.set_files([path, path.with_suffix(".channels.toml")])
    said = page.locator("[data-measured=deviations]")
    said.wait_for()
    look.settled_anew()
    assert "order 2 of hub" in said.inner_text() and "its peak comes" in said.inner_text()
    assert len(left_in(tmp_path)) == 2
    page.screenshot(path=str(tmp_path / "measured.png"), full_page=True)
    # Three pictures are drawn, and saved.
    assert (
        page.evaluate("Bokeh.documents[0]._all_models.values().toArray().filter(m => m.type === 'Figure').length") == 3
    )
    for link in page.locator("a[download]", has_text="SVG").all():
        with page.expect_download() as saved:
            link.click()
        assert "<svg" in Path(saved.value.path()).read_text()[:2000]
    # The number that explains it, moved by hand.
    page.get_by_role("button", name="Forget the file").click()
    page.wait_for_function("() => !document.querySelector('[data-measured=deviations]')")
    look.settled_anew()
    assert left_in(tmp_path) == []
    # Dropped, with a hostile name, and of no kind that signals have.
    zone = page.locator(".zone")
    zone.evaluate(ONTO, [["<img src=x onerror=alert(1)>.exe", 10, None]])
    page.locator(".zone span[role=alert]", has_text="is not a file of signals").wait_for()
    zone.evaluate(ONTO, [["a.wav", 1, None], ["b.wav", 1, None]])
    page.locator(".zone span[role=alert]", has_text="give one measured file").wait_for()
    text = edges().decode()
    dropped = [["run.csv", 0, text], ["run.channels.toml", 0, TOML]]
    zone.evaluate(ONTO, dropped)
    said.wait_for()
    look.settled_anew()
    assert len(left_in(tmp_path)) == 2 and look.errors == []
    # The page is closed: its file goes within a minute.
    context.close()
    for _ in range(90):
        if not left_in(tmp_path):
            break
        time.sleep(1.0)
    assert left_in(tmp_path) == []


@pytest.mark.slow
@pytest.mark.parametrize("killed", [False, True])
def test_nothing_stays_where_the_server_ends(tmp_path: Path, server_here: Server, browser: Any, killed: bool) -> None:
    page = browser.new_context().new_page()
    page.set_default_timeout(180_000)
    look = Look(page, server_here).at("?view=measured")
    (tmp_path / "run.csv").write_bytes(edges())
    (tmp_path / "run.channels.toml").write_text(TOML)
    page.get_by_label("Measured file").set_input_files([tmp_path / "run.csv", tmp_path / "run.channels.toml"])
    page.locator("[data-measured=deviations]").wait_for()
    page.wait_for_selector(IDLE)
    assert len(left_in(tmp_path)) == 2
    if killed:
        look.server.process.kill()
        look.server.process.wait(60)
    else:
        look.server.stop()
    for _ in range(60):
        if not left_in(tmp_path):
            break
        time.sleep(0.5)
    assert left_in(tmp_path) == []
