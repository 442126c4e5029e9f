"""What the stability of a line with stages leaves out where excitations may move it across them."""

from __future__ import annotations

from trunnion.driveline.features import feature
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import line_harmonics
from trunnion.equations.steady_base import has_periodic_base
from trunnion.results.finding import Finding, Gravity


def shaken_stages(assembly: Assembly) -> tuple[Finding, ...]:
    """What is said of a line that is judged about its own periodic motion, without its excitations, where these may
    move it across the stages of a spring: then they move its multipliers."""
    if not has_periodic_base(assembly):
        return ()
    backlash = set(feature("backlash").places(assembly.line))
    staged = [
        name for name, one in assembly.line.parts
        if (isinstance(one, PiecewiseShaft) and one.breakpoints) or any(at.startswith(f"{name}.") for at in backlash)
    ]  # fmt: skip
    acting = [one.name for one in line_harmonics(assembly) if one.acts]
    if not (staged and acting):
        return ()
    sentence = (
        f"{', '.join(dict.fromkeys(acting))} may move {', '.join(dict.fromkeys(staged))} across its stages, which the "
        "periodic motion that is judged leaves out: ask periodic_response"
    )
    return (Finding(Gravity.CAUTION, sentence),)
