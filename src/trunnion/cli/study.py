"""``trunnion study``: one analysis at very many points, and what is done of it."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from trunnion.cli import output
from trunnion.cli.readers import TABLES_ANYWHERE, read_time
from trunnion.cli.typed import Json, Within
from trunnion.driveline.refusals import nearest
from trunnion.errors import ComputationError, InputError
from trunnion.results.counts import counted

if TYPE_CHECKING:
    from trunnion.studies.result import Study
    from trunnion.studies.runner import StudyProgress

OF_STORES = ("status", "resume", "show", "boundary", "export")
"""What can be asked of a store that is there."""
EVERY = 0.2
"""Seconds between two states of the line of progress on a terminal."""


def study(
    what: Annotated[
        str,
        typer.Argument(
            metavar="FILE|status|resume|show|boundary|export", help="Study file (TOML), or what to do with a STORE."
        ),
    ],
    store: Annotated[
        str | None, typer.Argument(metavar="STORE", help="The folder that a study wrote, truck.zarr say, or its file.")
    ] = None,
    outputs: Annotated[
        list[Path] | None,
        typer.Option(
            "--output",
            "-o",
            metavar="PATH",
            help="File to write: .nc, .csv or .parquet of export, .png, .pdf or .svg of show; repeat it for more.",
        ),
    ] = None,
    of: Annotated[
        str | None,
        typer.Option("--of", metavar="QUANTITY", help="Quantity that the picture shows; default: the first."),
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(
            "--kind", metavar="KIND", help="Kind of picture: chart, slices, histogram, parallel, boundary or shares."
        ),
    ] = None,
    x: Annotated[
        str | None,
        typer.Option("--x", metavar="PARAMETER", help="Parameter along x of the picture; default: the speed."),
    ] = None,
    y: Annotated[
        str | None, typer.Option("--y", metavar="PARAMETER", help="Parameter along y of the chart, or of the slices.")
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            "--at",
            metavar="PARAMETER=VALUE",
            help='Where another parameter stands in a picture or on a boundary: "HookeJoint 1.angle=5 deg"; repeat it.',
        ),
    ] = None,
    along: Annotated[
        str | None, typer.Option("--along", metavar="PARAMETER", help="Of boundary: tell where it is crossed.")
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option("--workers", min=0, help="Processes of this machine; default: one per core; 0 computes here."),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler", metavar="ADDRESS", help="Address of a Dask scheduler to use instead: tcp://host:8786."
        ),
    ] = None,
    memory: Annotated[
        str | None,
        typer.Option("--memory", metavar="SIZE", help='Most memory of one process: "2 GiB".'),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Compute a few points only, and say what all would cost.")
    ] = False,
    verify: Annotated[
        bool, typer.Option("--verify", help="First read back all that is there; compute anew what is damaged.")
    ] = False,
    within: Within = None,
    as_json: Json = False,
) -> None:
    """Ask an analysis at very many points, on all cores or a cluster; resume, show and export what is kept.

    Example: trunnion study truck-study.toml, then trunnion study show truck.zarr
    """
    from trunnion.studies.extra import require_all

    if not dry_run:
        require_all()
    if outputs and what not in ("show", "export"):
        remedy = "leave it out, and write: trunnion study export STORE --output PATH, once the study has run"
        raise InputError("is nothing that it writes", key="--output", value=str(outputs[0]), remedy=remedy)
    if what in OF_STORES:
        if store is None:
            raise InputError("is missing", key="STORE", remedy=f"write: trunnion study {what} truck.zarr")
        given = {"workers": workers, "scheduler": scheduler, "memory": memory, "verify": verify}
        stands = _stands(at or [])
        if what == "boundary":
            _boundary(_store_of(store), along or "", stands, as_json)
            return
        shown = {"quantity": of or "", "kind": kind or "", "x": x or "", "y": y or "", "at": stands}
        _of_store(what, _store_of(store), outputs or [], given, within, as_json, shown)
        return
    if store is not None:
        raise InputError("is nothing that is asked of a store", key="study", value=what,
                         remedy=nearest(what, OF_STORES))  # fmt: skip
    if dry_run:
        from trunnion.studies.study import study_cost

        cost = study_cost(what, tables_anywhere=TABLES_ANYWHERE.get(), workers=workers)
        output.write_json("study", cost.to_dict()) if as_json else output.say(str(cost))
        return
    from trunnion.studies.study import study as run_study

    seconds = None if within is None else read_time(within, "--within")
    with _reported(seconds) as report:
        found = run_study(what, workers=workers, scheduler=scheduler, memory=memory, verify=verify, progress=report,
                      tables_anywhere=TABLES_ANYWHERE.get())  # fmt: skip
    _say(found, as_json)


def _store_of(place: str) -> str:
    """The store at ``place``, or the one that a study's file there names."""
    if not Path(place).is_file():
        return place
    from trunnion.studies.description import read_description

    stated, folder = read_description(place)
    return str(folder / stated.store)


def _of_store(
    what: str,
    store: str,
    outputs: list[Path],
    given: dict[str, Any],
    within: str | None,
    as_json: bool,
    shown: dict[str, Any],
) -> None:
    if what == "status":
        _status(store, as_json)
    elif what == "resume":
        from trunnion.studies.study import resumed

        seconds = None if within is None else read_time(within, "--within")
        with _reported(seconds) as report:
            found = resumed(store, progress=report, **given)
        _say(found, as_json)
    elif what == "export":
        from trunnion.studies.exports import ENDINGS, export

        if not outputs:
            raise InputError("is missing", key="--output", remedy=f"give a file ending in one of {', '.join(ENDINGS)}")
        paths = [export(store, path) for path in outputs]
        output.write_json("study", {"written": [str(path) for path in paths]}) if as_json else output.written(paths)
    else:
        from trunnion.studies.result import read

        found = read(store)
        if outputs:
            _draw(found, outputs, shown)
            if not as_json:
                output.written(outputs)
                return
        _say(found, as_json, whole=False)
        if not as_json:
            _say_sensitivities(found)


def _stands(stated: list[str]) -> dict[str, str]:
    """Where parameters stand, by path, as texts.

    Raises
    ------
    InputError : one is not written as PARAMETER=VALUE.
    """
    found = {}
    for one in stated:
        path, sign, value = one.partition("=")
        if not (path.strip() and sign and value.strip()):
            raise InputError("is not PARAMETER=VALUE", key="--at", value=one,
                             remedy='write --at "HookeJoint 1.angle=5 deg", say')  # fmt: skip
        found[path.strip()] = value.strip()
    return found


def _boundary(store: str, along: str, at: dict[str, str], as_json: bool) -> None:
    """The boundary of a store, and where a line along one parameter crosses it."""
    from trunnion.results.words import Words
    from trunnion.studies.boundary import study_boundary
    from trunnion.studies.result import read

    found = study_boundary(read(store))
    if not along:
        if at:
            raise InputError("is missing", key="--along", remedy=f"write --along {found.parameter[0]!r}, say")
        output.write_json("study", found.to_dict()) if as_json else output.say(str(found))
        return
    rows = found.crossings(along, at)
    if as_json:
        names = ("estimate", "low", "high")
        crossings = [dict(zip(names, row, strict=True)) for row in rows.tolist()]
        output.write_json("study", {"side": found.side, "along": along, "at": at, "crossings": crossings})
        return
    unit = found.unit_of[found.parameter.index(along)]
    words = Words(found.study.unit).parameter(along, unit)
    output.say(f"{found.side}: {counted(len(rows), 'crossing')} along {along}")
    for estimate, low, high in rows.tolist():
        between = f"between {words.number(low, 6)} and {words.number(high, 6)}"
        known = f"{words.number(estimate, 6)}, " if estimate == estimate else "crossed twice, or not, "
        output.say(f"  {known}{between}")


def _draw(found: Study, paths: list[Path], shown: dict[str, Any]) -> None:
    """One picture, into every file."""
    from trunnion.pictures.draw_matplotlib import draw, save
    from trunnion.pictures.formats import check_format
    from trunnion.pictures.studies import shares, study
    from trunnion.studies.sensitivities import study_sensitivities

    for path in paths:
        check_format(path)
    if shown["kind"] == "shares":
        picture = shares(study_sensitivities(found, shown["quantity"] or found.quantities[0].path))
    else:
        at = found.values_at(shown["at"])
        picture = study(found, quantity=shown["quantity"], kind=shown["kind"], x=shown["x"], y=shown["y"], at=at)
    figure = draw(picture).figure.figure
    for path in paths:
        save(figure, path)


def _say_sensitivities(found: Study) -> None:
    """What the numbers of a sampled study follow."""
    from trunnion.studies.sensitivities import study_sensitivities

    if found.design.sampling is None or found.design.axes:
        return
    for one in found.quantities:
        if one.kind == "number":
            try:
                output.say(str(study_sensitivities(found, one.path)))
            except ComputationError as error:
                output.say(f"no sensitivities of {one.path}: {error}")


def _status(store: str, as_json: bool) -> None:
    from trunnion.results.durations import time_text
    from trunnion.studies.store import Store

    opened = Store.open(Path(store))
    counts = opened.counts()
    if as_json:
        about = {"points": counts.points, "done": counts.done, "failed": counts.failed, "missing": counts.missing,
                 "seconds": counts.seconds, "reasons": dict(counts.reasons), **opened.about["computed_by"]}  # fmt: skip
        output.write_json("study", {"store": store, "analysis": opened.question.analysis, **about})
        return
    output.say(f"{opened.question.analysis} in {store}: {counts.points} points, {counts.done} done, {counts.failed} "
               f"failed, {counts.missing} missing")  # fmt: skip
    if counts.seconds:
        output.say(f"  {time_text(counts.seconds)} of computing so far")
    for sentence, count in counts.reasons:
        output.say(f"  failed at {count}: {sentence}")


def _say(found: Study, as_json: bool, *, whole: bool = True) -> None:
    """The study in words, or what it says as JSON; exit code 1 where points are missing that were asked for."""
    if as_json:
        content = {key: value for key, value in vars(found).items() if isinstance(value, str | int)}
        output.write_json("study", {**content, "missing": found.missing, "reasons": dict(found.reasons)})
    else:
        output.say(str(found))
        if found.refinement is not None:
            from trunnion.studies.boundary import study_boundary

            with suppress(ComputationError):  # its first grid is not whole yet
                output.say(str(study_boundary(found)))
    if whole:
        output.finish(found.outcome, [Path(found.store)])


@contextmanager
def _reported(within: float | None) -> Iterator[Callable[[StudyProgress], None]]:
    """StudyProgress on stderr; Ctrl-C and a time limit end the run with what it has."""
    terminal = sys.stderr.isatty()
    last = 0.0 if terminal else time.monotonic()
    named = False

    def report(state: StudyProgress) -> None:
        nonlocal last, named
        if state.dashboard and not named:
            named = True
            output.note(f"{state.workers} workers; watch them at {state.dashboard}")
        now = time.monotonic()
        if now - last < (EVERY if terminal else output.LONG):
            return
        last = now
        line = progress_line(state)
        if terminal:
            print(f"\r{line:<100}", end="", file=sys.stderr, flush=True)
        else:
            output.note(line)

    with output.stoppable(within), output.compile_notice():
        try:
            yield report
        finally:
            if terminal:
                print("\r" + " " * 100 + "\r", end="", file=sys.stderr, flush=True)


def progress_line(state: Any) -> str:
    """One line about how far a study is."""
    from trunnion.numerics.memory import size_text
    from trunnion.results.durations import time_text

    parts = [f"study: {100 * state.share:.1f} %", f"{state.rate:.3g} points/s"]
    if state.left < float("inf"):
        parts.append(f"about {time_text(max(state.left, 1.0))} left")
    if state.failed:
        parts.append(f"{state.failed} failed")
    if held := state.bytes:
        parts.append(f"workers hold {size_text(held)}")
    return ", ".join(parts)
