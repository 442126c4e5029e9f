"""What can be looked at: one file a view."""

from __future__ import annotations

from trunnion import registry
from trunnion.app.views.base import View

VIEWS: tuple[type[View], ...] = tuple(registry.found_at(address) for address in registry.VIEWS.values())
"""In the order of the page."""
