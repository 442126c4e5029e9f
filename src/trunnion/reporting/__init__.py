"""From results to the one HTML file an engineer hands on."""

from trunnion.reporting.report import Report, report

__all__ = ["Report", "report"]
