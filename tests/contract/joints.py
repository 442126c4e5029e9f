"""One of each kind of joint that does not pass rotation unchanged: what the contract of joints goes through."""

from __future__ import annotations

import trunnion as tn
from trunnion.driveline.joints import Joint

RIPPLE = [{"order": 2, "amplitude": 0.02, "phase": 0.3}, {"order": 6, "amplitude": 1e-3}]
JOINTS: dict[str, Joint] = {
    "HookeJoint": tn.HookeJoint(angle=0.6, plane=0.2),
    "TripodJoint": tn.TripodJoint(angle=0.7, radius=0.06, length=0.15, spider="input"),
    "RzeppaJoint": tn.RzeppaJoint(angle=0.4, reference_angle=0.3, ripple=RIPPLE),
    "DoubleCardanJoint": tn.DoubleCardanJoint(angle=0.8, distance_ratio=1.4),
}
