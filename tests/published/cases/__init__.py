"""Every printed number, by kind; ``BATCHES`` and ``SOURCES`` gather them."""

from __future__ import annotations

from published.cases import chains, chaos, damping, engines, forced, joints, mathieu, papers
from published.printed_numbers import Batch, Source

KINDS = {
    "Free vibration": chains,
    "Forced vibration": forced,
    "Engines": engines,
    "Dampers and fatigue": damping,
    "Joints": joints,
    "Parametric stability": mathieu,
    "Chaos": chaos,
    "The papers' own frequencies": papers,
}
"""Modules of cases by the heading of the page that prints them."""
BATCHES: tuple[Batch, ...] = tuple(batch for module in KINDS.values() for batch in module.BATCHES)
SOURCES: dict[str, Source] = {key: one for module in KINDS.values() for key, one in module.SOURCES.items()}
