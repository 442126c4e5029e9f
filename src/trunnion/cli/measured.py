"""Commands about measured data."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.command_input import CommandInput, CommandSubject, InputAttribute, NumberBounds, OptionReader, Texts
from trunnion.cli.files import check_line_file, check_not_read, check_report_file
from trunnion.cli.options import Progress, SpeedUnit, Unit
from trunnion.cli.places import CommandOutput
from trunnion.cli.readers import file_of_line, read_line
from trunnion.cli.typed import Command
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.results.speeds import speed_factor

if TYPE_CHECKING:
    from trunnion.measured.signals.measurement import Measurement

DATA = typer.Argument(metavar="DATA", help="Measured signals: .csv, .mat, .h5, .wav, .mf4, .tdms, .uff.")
OVER = {"response": "plot", "campbell": "plot_campbell", "run-up": "plot_run_up"}
"""Pictures of a comparison, by what they lay measured orders over."""
Channels = Annotated[
    str | None,
    typer.Option(
        "--channels", metavar="TOML", help="Description of its columns; default: DATA ending in .channels.toml."
    ),
]


def _recorded(file: str, texts: Texts) -> CommandInput:
    unit = texts["unit"] or ""
    speed_factor(unit or "rpm")
    return CommandInput(tn.read_measurement(file, texts["channels"]), file, unit, texts)


Recorded = Annotated["Measurement", DATA, CommandSubject(_recorded, {"unit": Unit, "channels": Channels})]


def _line(asked: CommandInput, text: str, key: str) -> tn.Driveline:
    return read_line(text)


def _orders(asked: CommandInput, text: str, key: str) -> list[float]:
    try:
        return [float(one) for one in text.split(",")]
    except ValueError:
        raise InputError("is not a list of orders", key=key, value=text, remedy='write "0.5,1,2"') from None


def _description(asked: CommandInput) -> Path:
    """Where the columns of the data are described."""
    from trunnion.measured.signals.channel_file import beside

    return Path(asked.texts["channels"] or beside(Path(asked.file)))


def _reference_run(asked: CommandInput, text: str, key: str) -> Any:
    """Pitch errors from a file, whose columns are those of the data where it has no description of its own."""
    from trunnion.measured.signals.channel_file import beside

    own = beside(Path(text))
    channels = own if own.is_file() else _description(asked)
    return tn.pitch_errors(tn.read_measurement(text, channels), unit=asked.unit or "rpm")


def _between(asked: CommandInput, text: str, key: str) -> tuple[float, float]:
    try:
        first, last = (float(one) for one in text.split(":"))
    except ValueError:
        raise InputError("is not a pair of times", key=key, value=text, remedy='write "3:27", in seconds') from None
    return first, last


@Command("track orders")
def track_orders(
    measurement: Recorded,
    *,
    orders: Annotated[list[float] | None, OptionReader(_orders)],
    line: Annotated[Any, OptionReader(_line)],
    reference: str = "",
    calibration: Annotated[Any, OptionReader(_reference_run)],
    between: Annotated[tuple[float, float] | None, OptionReader(_between)],
    window: Annotated[int, NumberBounds(1, 1000)] = 8,
    channel: str = "",
    progress: Progress,
    unit: SpeedUnit,
) -> CommandOutput:
    """Example: trunnion track-orders run-up.wav --line truck.toml --orders 1,2,4 -o orders.png

    --orders K,K,…  Cycles per turn of the input; default: those that stand out of the noise.
    --line FILE  Driveline that the channels are of: gives speed ratios.
    --reference  Channel that the rotation is taken from; default: the first with pulses.
    --calibration DATA  Reference run: pitch errors of the wheels are taken from it.
    --between FIRST:LAST  Part of the recording, times in seconds; default: the longest run-up or run-down.
    --window  Turns of one window.
    --channel  Channel that is drawn; default: the first.
    """
    found = tn.track_orders(
        measurement, orders, line=line, reference=reference, calibration=calibration, window=window, between=between,
        unit=unit, progress=progress,
    )  # fmt: skip
    if channel:
        found.column(channel)

    def more() -> None:
        output.table(found.table(), "Largest of each order")
        output.findings(found.findings)

    return CommandOutput(
        found, draw=partial(found.plot, channel=channel), text=lambda: found.headline, more=more,
        content=lambda: found.to_dict() | {"findings": output.findings_json(found.findings)},
    )  # fmt: skip


def _required_line(asked: CommandInput) -> tn.Driveline:
    raise InputError("is missing", key="--line", remedy="name the driveline file that the data are of")


NeededLine = Annotated[Any, OptionReader(_line, missing=_required_line)]


@Command("compare measured")
def compare_measured(
    measurement: Recorded,
    *,
    line: NeededLine,
    orders: Annotated[list[float] | None, OptionReader(_orders)],
    reference: str = "",
    calibration: Annotated[Any, OptionReader(_reference_run)],
    between: Annotated[tuple[float, float] | None, OptionReader(_between)],
    window: Annotated[int, NumberBounds(1, 1000)] = 8,
    channel: str = "",
    over: str = "response",
    report: Path | None = None,
    asked: Annotated[CommandInput, InputAttribute("itself")],
    progress: Progress,
    unit: SpeedUnit,
) -> CommandOutput:
    """Example: trunnion compare-measured run-up.wav --line truck.toml --orders 1,2,4 -o overlay.png

    --line FILE  Driveline that the data are of.
    --orders K,K,…  Cycles per turn of the input; default: those that stand out of the noise.
    --reference  Channel that the rotation is taken from; default: the first with pulses.
    --calibration DATA  Reference run: pitch errors of the wheels are taken from it.
    --between FIRST:LAST  Part of the recording, times in seconds; default: the longest run-up or run-down.
    --window  Turns of one window.
    --channel  Channel that is drawn; default: the first that moves.
    --over  What the picture lays the orders over: "response" (default), "campbell" or "run-up".
    --report PATH  Writes the report on the line, NAME.html, with a section on what was measured.
    """
    if over not in OVER:
        raise InputError("is not a picture", key="--over", value=over, remedy=nearest(over, list(OVER)))
    if report is not None:
        check_report_file(report, "--report")
    data = tn.track_orders(
        measurement, orders, line=line, reference=reference, calibration=calibration, window=window, between=between,
        unit=unit,
    )  # fmt: skip
    found = tn.compare_measured(line, data)
    if channel:
        data.column(channel)
    written = []
    if report is not None:
        page = tn.report(line, unit=unit or None, source=asked.texts["line"], measured=data, progress=progress)
        written.append(page.save(report))
    return CommandOutput(
        found, draw=partial(getattr(found, OVER[over]), channel=channel), written=written,
        more=lambda: output.table(found.table(), "Differences"),
        content=lambda: found.to_dict() | {"findings": output.findings_json(found.findings)},
    )  # fmt: skip


def _bounds(asked: CommandInput, text: str, key: str) -> tuple[str, tuple[float | str, float | str]]:
    parts = text.rsplit(":", 2)
    if len(parts) != 3:
        raise InputError(
            "is not a parameter with bounds", key=key, value=text, remedy='write "tube.stiffness:10kN*m/rad:40kN*m/rad"'
        )
    return parts[0], (_end(parts[1]), _end(parts[2]))


def _end(text: str) -> float | str:
    """A bare number is in SI units, as everywhere at the command line."""
    try:
        return float(text)
    except ValueError:
        return text


def _apart(free: list[tuple[str, tuple[float | str, float | str]]]) -> dict[str, tuple[float | str, float | str]]:
    """Bounds by parameter, each named once."""
    for name in (twice for k, (twice, _) in enumerate(free) if twice in dict(free[:k])):
        raise InputError("is named twice", key="--free", value=name, remedy="give it one pair of bounds")
    return dict(free)


def _speeds(asked: CommandInput, text: str, key: str) -> list[float]:
    from trunnion.cli.readers import read_speed
    from trunnion.driveline.operating_speed import speed_unit

    if not asked.unit:  # that of the line: bare numbers are in it
        asked = replace(asked, unit=speed_unit(read_line(asked.texts["line"])))
    return [read_speed(asked, one, key) for one in text.split(",")]


@Command("identify")
def identify(
    measurement: Recorded,
    *,
    line: NeededLine,
    free: Annotated[list[tuple[str, tuple[float | str, float | str]]], OptionReader(_bounds, several=True)],
    orders: Annotated[list[float] | None, OptionReader(_orders)],
    reference: str = "",
    calibration: Annotated[Any, OptionReader(_reference_run)],
    between: Annotated[tuple[float, float] | None, OptionReader(_between)],
    window: Annotated[int, NumberBounds(1, 1000)] = 8,
    tongue_at: Annotated[list[float] | None, OptionReader(_speeds)],
    draws: Annotated[int, NumberBounds(0, 100_000)] = 0,
    write: Path | None = None,
    channel: str = "",
    asked: Annotated[CommandInput, InputAttribute("itself")],
    progress: Progress,
    unit: SpeedUnit,
) -> CommandOutput:
    """Example: trunnion identify run-up.wav --line truck.toml --free "tube.stiffness:10 kN*m/rad:40 kN*m/rad"

    --line FILE  Driveline that the data are of, as it is thought to be.
    --free PARAMETER:LOW:HIGH  What may differ, with its bounds; repeat it for more.
    --orders K,K,…  Cycles per turn of the input; default: those that stand out of the noise.
    --reference  Channel that the rotation is taken from; default: the first with pulses.
    --calibration DATA  Reference run: pitch errors of the wheels are taken from it.
    --between FIRST:LAST  Part of the recording, times in seconds; default: the longest run-up or run-down.
    --window  Turns of one window.
    --tongue-at SPEED,…  Input speeds at which to give the distance from the nearest instability.
    --draws STEPS  Where a likelihood is not Gaussian, steps of an ensemble that draws from it, 400 say.
    --write PATH  Write the driveline with the values found.
    --channel  Channel that is drawn; default: the first that moves.
    """
    if not free:
        raise InputError("is missing", key="--free", remedy='write --free "tube.stiffness:10kN*m/rad:40kN*m/rad"')
    bounds = _apart(free)
    if write is not None:
        check_line_file(write, "--write")
        check_not_read([write], [str(_description(asked))], "--write")
    data = tn.track_orders(
        measurement, orders, line=line, reference=reference, calibration=calibration, window=window, between=between,
        unit=unit,
    )  # fmt: skip
    if channel:
        data.column(channel)
    found = tn.identify(line, data, bounds, tongue_at=tongue_at or (), draws=draws, progress=progress)
    if write is not None:
        tn.dump(found.line, write, comments_of=file_of_line(asked.texts["line"]))

    def more() -> None:
        output.table(found.table(), "Parameters")
        for one in found.changes:
            output.say(f"  {one}")
        output.findings(found.findings)

    return CommandOutput(
        found, draw=partial(found.plot, channel=channel), written=[write] if write else [],
        text=lambda: found.headline, more=more,
        content=lambda: found.to_dict() | {"findings": output.findings_json(found.findings)},
    )  # fmt: skip
