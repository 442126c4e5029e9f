"""No text and no picture of a line that states its speeds in rpm says rad/s, whatever the analysis.

Datasets stay in SI and say so by their ``units``. An analysis without an entry here fails by name.
"""

import re
from collections.abc import Iterator
from typing import Any

import matplotlib.text
import pytest
from matplotlib.figure import Figure
from oracles.sampling import quick_only
from questions import QUESTIONS

import trunnion as tn
from trunnion.features import TABLE
from trunnion.registry import PICTURES

RAD_PER_SECOND = re.compile(r"rad/s(?! ?(\^2|²))")


def test_every_analysis_is_asked() -> None:
    assert QUESTIONS.keys() == TABLE.keys()


@pytest.mark.parametrize("analysis", quick_only([name for name in QUESTIONS if name != "certify_chaos"], QUESTIONS))
def test_nothing_says_radians_per_second(analysis: str) -> None:
    result = QUESTIONS[analysis].in_rpm()
    said = [str(result), *sentences(result), *drawn(result)]
    assert said[0] and not [text for text in said if RAD_PER_SECOND.search(text)]


def sentences(result: Any) -> Iterator[str]:
    for name in ("findings", "outcome"):
        found = getattr(result, name, ())
        yield from map(str, found if isinstance(found, tuple) else (found,))


def drawn(result: Any) -> Iterator[str]:
    """All text of all pictures that there are of ``result``."""
    for kind in type(result).__mro__:
        for name in (key.partition(".")[2] for key in PICTURES if key.startswith(f"{kind.__name__}.")):
            try:
                picture = getattr(result, name)()
            except tn.InputError:
                continue  # nothing to draw in so small a case
            figure = picture if isinstance(picture, Figure) else picture.figure
            yield from (text.get_text() for text in figure.findobj(matplotlib.text.Text))
