"""In continuous integration (``CI`` is set) a test that is skipped has failed, but for reasons known beforehand."""

from __future__ import annotations

import os
from collections.abc import Generator

import pytest

KNOWN = (
    "this machine has no other address",
    "no extended precision on this processor",
)
Report = pytest.TestReport | pytest.CollectReport


def judged(report: Report) -> Report:
    """The report of a test or a file; failed where it is skipped in continuous integration for a reason not known."""
    skipped = report.skipped and not hasattr(report, "wasxfail")
    if skipped and os.environ.get("CI") and not any(reason in str(report.longrepr) for reason in KNOWN):
        report.outcome = "failed"
        report.longrepr = f"skipped in continuous integration: {report.longrepr}"
    return report


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    return judged((yield))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    return judged((yield))
