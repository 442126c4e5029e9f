"""What a check compares, over the speeds that it is judged at: for pictures of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.driveline.quantities import QuantityKind
from trunnion.response.orders.result import OrderResponse

SWING = "half peak to peak"
WHOLE = "largest, mean included"


@dataclass(frozen=True)
class ResponseCurve:
    """Values over ``speed`` (speed,) of the input [rad/s], in SI units of ``kind``.

    quantity, says: what it is ("speed fluctuation of flywheel") and what of it is taken; value (speed,): compared with
    ``limits`` (speed,) by name, the one that the check is about first. by_order (speed, order): what single orders
    make of it, each of so many turns and so much beyond [rad/s]; no columns where they are of another quantity.
    """

    quantity: str
    kind: QuantityKind
    says: str
    speed: Array
    value: Array
    limits: Mapping[str, Array]
    order: Array
    frequency: Array
    by_order: Array


def course(
    response: OrderResponse,
    quantity: str,
    kind: QuantityKind,
    says: str,
    value: Array,
    limits: Mapping[str, float | Array],
    by_order: Array | None = None,
    inside: Flags | None = None,
) -> ResponseCurve:
    """The course of ``value`` (speed,), of the speeds of ``response`` or those ``inside``."""
    speed = response.speed if inside is None else response.speed[inside]
    over = {name: np.broadcast_to(np.asarray(limit, dtype=float), speed.shape) for name, limit in limits.items()}
    if by_order is None:
        nothing = np.zeros(0)
        return ResponseCurve(
            quantity=quantity, kind=kind, says=says, speed=speed, value=value, limits=over, order=nothing,
            frequency=nothing, by_order=np.zeros((len(speed), 0)),
        )  # fmt: skip
    return ResponseCurve(
        quantity=quantity, kind=kind, says=says, speed=speed, value=value, limits=over, order=response.order,
        frequency=response.frequency, by_order=by_order,
    )  # fmt: skip
