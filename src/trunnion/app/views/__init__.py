"""What can be looked at: one file a view."""

from __future__ import annotations

from trunnion.app.views.base import View
from trunnion.app.views.driveline import DrivelineView
from trunnion.app.views.verdict import VerdictView

VIEWS: tuple[type[View], ...] = (DrivelineView, VerdictView)
"""In the order of the page."""
