"""Frequencies that the papers print; ``trunnion.reproduce`` computes their figures, tables and conclusions."""

from __future__ import annotations

from typing import Any

import numpy as np
from published.printed_numbers import Batch, Source, Verdict

import trunnion as tn
from trunnion.driveline.quantities import DEGREE
from trunnion.papers.double_tripod.published import DoubleTripod
from trunnion.papers.three_shaft_cardan import study as three_shafts
from trunnion.papers.two_shaft_cardan import study as two_shafts

SOURCES = {
    "S1": Source(
        "Soltan Rezaee and Ghazavi, Modares Mechanical Engineering 14 (12), 2014, 163-170",
        "the article: equations 25 and 26, tables 1 and 2",
    ),
    "S3": Source(
        "Soltan Rezaee and co-authors, Modares Mechanical Engineering 12 (6), March 2013 (in Persian)",
        "the article: equation 20, tables 1 and 2",
    ),
    "S4": Source("Bugaru and Vasile, Applied Sciences 12, 2022, 6182", "the article: section 6"),
}
BRACKET = (
    "equation 25 with its bracket mended gives the computed value; equation 26 and the tables do not follow from it"
)
FAULT = (Verdict.SOURCE, BRACKET)


def resonances(table: Any, modes: Any) -> tuple[dict[str, str], list[float]]:
    """Printed resonance speeds by name, and those of the computed frequencies."""
    printed, computed = {}, []
    for kind, which, k, value in table:
        w = [modes[i - 1] for i in which]
        base = w[0] if len(w) == 1 else w[0] + w[1] if kind == "sum" else w[1] - w[0]
        step = 2 * k - 1 if kind == "subharmonic" else 2 * k
        name = "+" if kind == "sum" else "−"
        letters = f"ω{which[0]}" if len(which) == 1 else f"(ω{which[-1]}{name}ω{which[0]})"
        printed[f"{kind} {letters}" + (f"/{step}" if step > 1 else "")] = f"{value:.3f}"
        computed.append(base / step)
    return printed, computed


def two() -> Any:
    """Frequencies for γ = 100, α = μ = 1."""
    return tn.natural_frequencies(tn.catalogue("two-shaft-cardan", inertia_of_disk_2=100.0)).undamped_frequency


def three() -> Any:
    """Frequencies of the base case."""
    return tn.natural_frequencies(tn.catalogue("three-shaft-cardan")).undamped_frequency


def tables(source: str, study: Any, modes: Any, otherwise: tuple[Verdict, str]) -> list[Batch]:
    """Tables 1 and 2 of a paper."""
    made = []
    for where, table in (("table 1", study.TABLE_1), ("table 2", study.TABLE_2)):
        printed, _ = resonances(table, np.ones(9))
        made.append(
            Batch(
                source, where, "", printed,
                lambda table=table: resonances(table, modes())[1],  # type: ignore[misc]
                otherwise=otherwise,
            )
        )  # fmt: skip
    return made


def _tripod() -> list[float]:
    made = DoubleTripod()
    found = []
    for which in ("input", "output"):
        omega = float(made.element(which).natural_frequency(9 * DEGREE))
        found += [omega, 2 * omega / (2 * np.pi)]
    return found


BATCHES = (
    Batch(
        "S1", "equation 26, γ = 100", "", {"ω₁": "0.072", "ω₂": "1.422"}, two,
        judged=dict.fromkeys(("ω₁", "ω₂"), FAULT),
    ),
    *tables("S1", two_shafts, two, FAULT),
    Batch("S3", "equation 20", "", {"ω₁": "0.178", "ω₂": "1.025", "ω₃": "1.737"}, three),
    *tables("S3", three_shafts, three, (Verdict.SOURCE, "rounded twice: from the rounded frequencies")),
    Batch(
        "S4", "section 6, at 9°", "rad/s and Hz",
        {"Ω₁": "9632", "2Ω₁/2π": "3066", "Ω₃": "8767", "2Ω₃/2π": "2792"}, _tripod,
        relative=2.5e-4, precision="geometry printed with three figures",
        judged={"Ω₃": (Verdict.SOURCE, "its own 2792 Hz gives 8771 rad/s")},
    ),
    Batch(
        "S4", "natural frequencies of the midshaft", "Hz",
        {f"ν{k}": text for k, text in enumerate(("1669.2", "3338.4", "5007.6", "6676.8", "8346"), start=1)},
        lambda: [float(one) for one in DoubleTripod().midshaft_frequencies()],
        relative=2e-4, precision="multiples of a rounded first frequency",
    ),
)  # fmt: skip
