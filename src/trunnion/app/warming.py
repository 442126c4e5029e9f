"""Small computations that load every kernel the views need, so that the first look does not wait for them."""

from __future__ import annotations

from math import pi

from trunnion.app.calls import LINE, Call
from trunnion.app.jobs import Job
from trunnion.driveline.starter import starter

_RPM = 2 * pi / 60
_ANGLE = "HookeJoint 1.angle"


def _job(call: Call, show: str = "nothing") -> Job:
    return Job(starter("two-shaft"), call, show)


WARMING = (
    _job(Call("tn.assess", (LINE,))),
    _job(Call("tn.stability", (LINE,))),
    _job(Call("tn.order_response", (LINE, (100.0, 150.0)))),
    _job(Call("tn.stability_chart", (LINE, ("speed", 300 * _RPM, 3000 * _RPM, 8), (_ANGLE, 0.0, 0.3, 6)))),
    _job(Call("tn.campbell_diagram", (LINE, (100.0, 150.0)))),
    _job(Call("tn.kinetostatics", (LINE,))),
)
