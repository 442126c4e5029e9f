"""What can be looked at: one file a view."""

from __future__ import annotations

from trunnion.app.views.base import View
from trunnion.app.views.driveline import DrivelineView
from trunnion.app.views.joints import JointsView
from trunnion.app.views.limits import LimitsView
from trunnion.app.views.motion import MotionView
from trunnion.app.views.orders import OrdersView
from trunnion.app.views.stability import StabilityView
from trunnion.app.views.verdict import VerdictView

VIEWS: tuple[type[View], ...] = (
    DrivelineView,
    VerdictView,
    OrdersView,
    StabilityView,
    JointsView,
    LimitsView,
    MotionView,
)
"""In the order of the page."""
