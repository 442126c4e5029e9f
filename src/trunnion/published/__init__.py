"""Drivelines of the literature, each with its source, as one catalogue."""

from trunnion.published.entries import Entry, catalogue, entries

__all__ = ["Entry", "catalogue", "entries"]
