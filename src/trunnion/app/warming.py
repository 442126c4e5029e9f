"""Small computations that load every kernel the views need, so that the first look does not wait for them."""

from __future__ import annotations

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.jobs import Job
from trunnion.driveline.quantities import RPM
from trunnion.driveline.starter import starter

CALLS = (
    Call("tn.assess", (LINE,)),
    Call("tn.stability", (LINE,)),
    Call("tn.order_response", (LINE, (100.0, 150.0))),
    Call("tn.stability_chart", (LINE, ("speed", 300 * RPM, 3000 * RPM, 8), ("HookeJoint 1.angle", 0.0, 0.3, 6))),
    Call("tn.campbell_diagram", (LINE, (100.0, 150.0))),
    Call("tn.kinetostatics", (LINE,)),
)
WARMING = tuple(Job(starter("two-shaft"), call, "nothing") for call in CALLS)
