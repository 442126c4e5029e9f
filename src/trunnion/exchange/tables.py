"""A line as one CSV table: a row for every drive, inertia, spring and gear, with units in the first line."""

from __future__ import annotations

import csv
import io
from fractions import Fraction

from trunnion.errors import InputError
from trunnion.exchange.network import FlangeDrive, FlangeGear, FlangeInertia, FlangeSpring, Item, Network, read_ratio

HEAD = (
    "name", "kind", "from", "to", "inertia [kg m^2]", "stiffness [N m/rad]", "damping [N m s/rad]", "ratio [1]",
    "load_torque [N m]", "viscous_load [N m s/rad]", "speed [rad/s]",
)  # fmt: skip
FORMULA = ("=", "+", "-", "@", "'")
"""What a spreadsheet takes for a formula, or for the mark before a text that looks like one."""
_LINE = "line"
_SAVED = "write it with trunnion export FILE --to csv"


def table_of(network: Network) -> str:
    """The table; a name that a spreadsheet would compute stands behind an apostrophe."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEAD)
    speed = "" if network.speed is None else repr(network.speed)
    if network.name or speed:
        writer.writerow([_guarded(network.name), _LINE, *[""] * (len(HEAD) - 3), speed])
    for one in network.items:
        writer.writerow([_guarded(one.name), *_cells(one)])
    return text.getvalue()


def _cells(one: Item) -> list[str]:
    match one:
        case FlangeDrive(_, at, speed):
            return ["drive", str(at), "", "", "", "", "", "", "", "" if speed is None else repr(speed)]
        case FlangeInertia(_, at, inertia, load, viscous):
            return ["inertia", str(at), "", repr(inertia), "", "", "", _or_none(load), _or_none(viscous), ""]
        case FlangeSpring(_, near, far, stiffness, damping):
            return ["spring", str(near), str(far), "", repr(stiffness), repr(damping), "", "", "", ""]
        case FlangeGear(_, near, far, ratio):
            return ["gear", str(near), str(far), "", "", "", str(ratio), "", "", ""]


def _or_none(value: float) -> str:
    return repr(value) if value else ""


def _guarded(name: str) -> str:
    return f"'{name}" if name.startswith(FORMULA) else name


def read_table(text: str, source: str) -> Network:
    """The network of a table.

    Raises
    ------
    InputError : names the row and column that are wrong.
    """
    try:
        rows = [row for row in csv.reader(io.StringIO(text)) if any(cell.strip() for cell in row)]
    except csv.Error:
        raise InputError("is not a CSV table", key=source, remedy=_SAVED) from None
    if not rows or tuple(cell.strip() for cell in rows[0]) != HEAD:
        raise InputError("does not begin with the columns of a line", key=source, remedy=_SAVED)
    found = Network("")
    for number, row in enumerate(rows[1:], start=2):
        _read_row(found, _TableRow(f"{source}: row {number}", [*row, *[""] * (len(HEAD) - len(row))]))
    return found


class _TableRow:
    """Cells of a row, read with complaints that name their place."""

    def __init__(self, place: str, cells: list[str]) -> None:
        self.place = place
        self.cells = dict(zip(HEAD, (cell.strip() for cell in cells), strict=False))

    @property
    def name(self) -> str:
        written = self.cells["name"]
        return written[1:] if written.startswith("'") else written

    def wrong(self, problem: str, column: str, remedy: str) -> InputError:
        return InputError(problem, element=self.place, key=column.partition(" ")[0], remedy=remedy)

    def flange(self, column: str) -> int:
        text = self.cells[column]
        if not (text.isascii() and text.isdigit() and len(text) < 10):
            raise self.wrong("is not a number of a flange", column, "write 0, 1, 2, …")
        return int(text)

    def number(self, column: str, usual: float | None = None) -> float:
        text = self.cells[column]
        if not text and usual is not None:
            return usual
        try:
            return float(text)
        except ValueError:
            raise self.wrong("is not a number", column, "write 2 or 2.5, say") from None

    def speed(self) -> float | None:
        return self.number("speed [rad/s]") if self.cells["speed [rad/s]"] else None

    def ratio(self) -> Fraction:
        try:
            return read_ratio(self.cells["ratio [1]"])
        except (ValueError, ZeroDivisionError):
            raise self.wrong("is not a ratio", "ratio", "write 41/10 or 4.1, say, and not zero") from None


def _read_row(found: Network, row: _TableRow) -> None:
    match row.cells["kind"]:
        case "line":
            found.name, found.speed = row.name, row.speed()
        case "drive":
            found.items.append(FlangeDrive(row.name, row.flange("from"), row.speed()))
        case "inertia":
            found.items.append(
                FlangeInertia(
                    row.name, row.flange("from"), row.number("inertia [kg m^2]"), row.number("load_torque [N m]", 0.0),
                    row.number("viscous_load [N m s/rad]", 0.0),
                )
            )  # fmt: skip
        case "spring":
            found.items.append(
                FlangeSpring(
                    row.name, row.flange("from"), row.flange("to"), row.number("stiffness [N m/rad]"),
                    row.number("damping [N m s/rad]", 0.0),
                )
            )  # fmt: skip
        case "gear":
            found.items.append(FlangeGear(row.name, row.flange("from"), row.flange("to"), row.ratio()))
        case _:
            raise row.wrong("is not a kind of part", "kind", "write drive, inertia, spring or gear")
