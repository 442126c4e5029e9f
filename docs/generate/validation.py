"""The page *Validation*: printed numbers beside computed ones, the five papers, other programs beside this one."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any

from generate.markdown import table, write

DATA = Path(__file__).parents[1] / "data"
MEANING = {
    "agrees": "the computed number rounds to the printed one",
    "within rounding": "it differs by up to one unit of the last printed figure",
    "within its precision": "it differs by less than the source states, or a drawing can be read to; the reason stands beside it",
    "source in error": "the source contradicts itself or its own equations; the reason stands beside it",
    "not decided": "the source leaves open what decides it",
    "disputed": "sources contradict each other; the reason stands beside it",
}
HEADS = ("", "published", "computed", "difference", "verdict")


def stored(name: str) -> dict[str, Any]:
    """What a generator in ``docs/data`` wrote."""
    found: dict[str, Any] = json.loads((DATA / f"{name}.json").read_text(encoding="utf-8"))
    return found


def figure(value: float, printed: str) -> str:
    """A computed number with two figures more than the printed one."""
    digits = len(re.sub(r"[eE].*|[^0-9]", "", printed).lstrip("0")) or 1
    return f"{value:.{min(digits + 2, 12)}g}"


def batch_rows(batch: Any, slow: dict[str, Any]) -> tuple[list[tuple[str, ...]], list[str], str]:
    """Rows of one table, its verdicts, and when it was computed if not now."""
    key = f"{batch.source}: {batch.where}"
    said = ""
    if batch.slow:
        kept = slow[key]
        values = [row["computed"] for row in kept["rows"]]
        again = type(batch)(**{**vars(batch), "compute": lambda: values})
        found = again.rows()
        said = f" Computed on {kept['on']} with version {kept['version']} in {kept['seconds']:g} s of processor time."
    else:
        found = batch.rows()
    rows = []
    for row in found:
        verdict = (
            f"**{row.verdict.value}**"
            if row.verdict.value in ("source in error", "disputed", "not decided")
            else row.verdict.value
        )
        because = f": {row.because}" if row.because else ""
        rows.append(
            (row.what, row.printed, figure(row.computed, row.printed), f"{row.difference:+.1e}", verdict + because)
        )
    return rows, [row.verdict.value for row in found], said


def printed_numbers() -> str:
    """All of ``tests/published/cases``."""
    from published.cases import KINDS, SOURCES

    slow = stored("printed_numbers")
    parts, counted, seen = [], Counter(), set()
    for kind, module in KINDS.items():
        parts.append(f"### {kind}")
        for batch in module.BATCHES:
            rows, verdicts, said = batch_rows(batch, slow)
            counted.update(verdicts)
            source = SOURCES[batch.source]
            unit = f" [{batch.unit}]" if batch.unit else ""
            read = "" if batch.source in seen else f" Read: {source.read}."
            seen.add(batch.source)
            parts += [f"**{source.title}: {batch.where}{unit}.**{read}{said}", table(HEADS, rows)]
    total = ", ".join(f"{verdict} {count}" for verdict, count in counted.most_common())
    head = [
        f"{sum(counted.values())} numbers of {len(seen)} sources whose figures were read. Verdicts: {total}.",
        table(("verdict", "means"), MEANING.items()),
    ]
    return "\n\n".join([*head, *parts])


NUMBER = re.compile(r"[-−+]?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def judged(printed: str, computed: str, remark: str) -> str:
    """Verdict of a row of a study where both sides are one number; else what the study says itself."""
    theirs, ours = NUMBER.fullmatch(printed.strip()), NUMBER.fullmatch(computed.strip())
    if not theirs or not ours:
        return ""
    from published.printed_numbers import last_place

    text = printed.strip().replace("−", "-")
    off = abs(float(computed.replace("−", "-")) - float(text))
    if off <= 0.501 * last_place(text):
        return "agrees"
    return "within rounding" if off <= 1.001 * last_place(text) else "differs"


def papers() -> str:
    """Tables, errata and conclusions of the five papers, as ``trunnion.reproduce`` computed them."""
    parts = []
    for name, study in stored("reproduced").items():
        head = f"### {study['title']}\n\n{study['source']}. Computed on {study['on']} with version {study['version']}, {study['seconds']:g} s."
        parts.append(head)
        for one in study["tables"]:
            rows = []
            for place, printed, computed, remark in one["rows"]:
                verdict = judged(printed, computed, remark)
                rows.append((place, printed or "–", computed, ": ".join(part for part in (verdict, remark) if part)))
            parts += [f"**{one['title']}**", table(("", "published", "computed", "verdict and remark"), rows)]
        rows = [(place, printed, computed, remark) for place, printed, computed, remark in study["errata"]]
        if rows:
            parts += [
                "**Where the source is in error**",
                table(("place", "printed", "derived or computed", "remark"), rows),
            ]
        parts += ["**What it concludes**", table(("statement", "verdict"), study["conclusions"])]
        figures = "; ".join(
            f"Figure {number}: {caption}" if number[:1].isdigit() else f"{number}: {caption}"
            for number, caption in study["figures"]
        )
        parts.append(f"Figures computed anew, with `trunnion reproduce {name}`: {figures}.")
    return "\n\n".join(parts)


def beside() -> str:
    """Other programs on the same lines, on one machine."""
    found = stored("beside")
    rows = [
        (
            one["question"],
            one["program"],
            one["difference"],
            f"{one['their_seconds']:.3g} s",
            f"{one['our_seconds']:.3g} s",
        )
        for one in found["cases"]
    ]
    versions = ", ".join(f"{name} {version}" for name, version in found["versions"].items())
    return "\n\n".join(
        [
            f"One machine, one thread, on {found['on']}: {versions}. Times are wall times of the second call. Each program runs in "
            "an environment of its own where its requirements clash (`docs/data/beside.py`).",
            table(("question", "program", "largest difference", "its time", "time here"), rows),
        ]
    )


def write_page(path: Path) -> None:
    """Three sections."""
    parts = [
        "# Validation",
        "This page is generated by running. A number is listed only where its figure was read; what of a source was read stands "
        "beside its first table. Tests hold every verdict (`tests/published`), and fail when one changes.",
        "## Printed numbers",
        printed_numbers(),
        "## The five papers",
        "Every table of the papers that Trunnion computes anew, with the verdict on each conclusion. Figures and readings: "
        "[published studies, computed anew](../reproduced.md).",
        papers(),
    ]
    if (DATA / "beside.json").exists():
        parts += ["## Other programs, side by side", beside()]
    write(path, "\n\n".join(parts))
