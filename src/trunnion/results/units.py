"""Numbers in text: beside their units, and with no more figures than are known."""

from __future__ import annotations

from math import degrees, floor, isfinite, log10

from trunnion.driveline.quantities import KINDS, SPEED, shown, signs

ROUNDING = 1e-10
"""Share of a swing below which a mean is what rounding left of 0."""


def range_words(low: str, high: str, between: str = "to") -> str:
    """ "40 to 60"; one where both ends print alike."""
    return low if low == high else f"{low} {between} {high}"


def with_unit(text: str, unit: str) -> str:
    """``text`` and its unit; the unit 1 of what has no dimension is left out."""
    return text if unit == "1" else f"{text} {signs(unit)}"


def in_words(value: float, unit: str, digits: int = 4) -> str:
    """A value in SI with an engineer's unit, "32.8 kN m/rad"; what is in rad/s is a frequency."""
    kind = next((kind for kind in KINDS if kind.unit == unit and kind is not SPEED), None)
    return with_unit(f"{value:.4g}", unit) if kind is None or unit == "1" else shown(value, kind, digits=digits)


def mean_and_swing(mean: float, swing: float, unit: str) -> str:
    """ "12 N m, 420 N m peak to peak"; a mean that is rounding beside the swing about it is 0."""
    shown = 0.0 if abs(mean) < ROUNDING * abs(swing) else mean
    return f"{shown:.6g} {unit}, {swing:.6g} {unit} peak to peak"


def figures(value: float, most: int = 4) -> str:
    """``most`` significant figures at most, never as a power of ten below 1e10: "1890", "0.9474"."""
    return f"{float(f'{value:.{most}g}'):.10g}"


def rounded_up(value: float, digits: int = 4) -> float:
    """The smallest number of so many significant figures that is not below a positive ``value``: of bounds in print."""
    if not (isfinite(value) and value > 0):
        return value
    near = float(f"{value:.{digits - 1}e}")
    return near if near >= value else float(f"{near + 10.0 ** (_place(value) - digits + 1):.{digits - 1}e}")


def rounded_down(value: float, digits: int = 4) -> float:
    """The largest number of so many significant figures that is not above a positive ``value``."""
    if not (isfinite(value) and value > 0):
        return value
    near = float(f"{value:.{digits - 1}e}")
    return near if near <= value else float(f"{near - 10.0 ** (_place(value) - digits + 1):.{digits - 1}e}")


def angle_words(angle: float, most: int = 3) -> str:
    """An angle [rad] in degrees, "14.3°"."""
    return f"{figures(degrees(angle), most)}°"


def order_words(order: float) -> str:
    """ "order 2", "order 0.9474": behind gears orders are not whole numbers."""
    return f"order {figures(order)}"


def amplification_words(gain: float) -> str:
    """ "20", "1890", and in words what has no damping."""
    return figures(gain, 3) if isfinite(gain) and gain < NO_DAMPING else "without bound"


NO_DAMPING = 1e9
"""Amplification from which a mode counts as undamped: its damping is rounding."""


def with_error(value: float, error: float, most: int = 6, beside: float = 0.0, sign: str = "") -> str:
    """``value ± error``: figures down to the error, at most ``most``, or as many as two of the distance from
    ``beside`` need, such as of a spectral radius from 1; an error that these figures cannot show stands after "error".
    """
    if not (isfinite(value) and isfinite(error)):
        return f"{value:{sign}g} ± {error:.1e}"
    size = abs(value) or error or 1.0
    apart = abs(value - beside) or size
    last = max(_place(size) - most + 1, _place(error) if error > 0 else -300)
    if beside:
        last = min(last, max(_place(apart) - 1, _place(error) if error > 0 else -300))
    digits = max(-last, 0)
    text = f"{value:{sign}.{digits}f}" if digits <= 15 else f"{value:{sign}.{most}g}"
    return f"{text} ± {figures(error, 2)}" if error >= 10.0**last else f"{text} (error {error:.1g})"


def _place(size: float) -> int:
    """Power of ten of the first figure."""
    return floor(log10(size))
