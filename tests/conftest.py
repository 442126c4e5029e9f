"""What all tests share: which of the slow ones are studies of many minutes, left to ``make studies``."""

from __future__ import annotations

import pytest

STUDIES = {
    "test_command_lines.py": "500 random command lines",
    "test_extremes_and_spectra.py": "50 gear lines against their exact motion",
    "test_features.py": "every feature crossed with every analysis, the costly ones too",
    "test_killed_and_full.py": "14 commands killed at 30 moments and on disks of 10 sizes",
    "test_long_lines.py": "250 disks",
    "test_mutated_files.py": "20 000 mutated files",
    "test_order_response.py": "100 lines against their nonlinear motion",
    "test_phase_axes.py": "500 points on each of 20 charts",
    "test_resonance_names.py": "2000 unstable points",
}
"""Files whose slow tests are studies, and what they go through."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.get_closest_marker("slow") and item.path.name in STUDIES:
            item.add_marker("study")
