"""The numbers of a description that an analysis can vary, by key, with their SI units."""

from __future__ import annotations

SPEED = "speed"
UNITS = {
    "speed": "rad/s",
    "stiffness": "N*m/rad",
    "damping": "N*m*s/rad",
    "loss_factor": "1",
    "relative_damping": "1",
    "mass": "kg",
    "loss_factor_frequency": "rad/s",
    "outer_diameter": "m",
    "inner_diameter": "m",
    "length": "m",
    "thickness": "m",
    "shear_modulus": "Pa",
    "density": "kg/m^3",
    "fork_offset": "rad",
    "inertia": "kg*m^2",
    "load_torque": "N*m",
    "viscous_load": "N*m*s/rad",
    "quadratic_load": "N*m*s^2/rad^2",
    "drive_share": "1",
    "angle": "rad",
    "plane": "rad",
    "reference_angle": "rad",
    "radius": "m",
    "distance_ratio": "1",
    "yoke_length": "m",
    "mesh_stiffness": "N/m",
    "mesh_damping": "N*s/m",
    "backlash": "m",
    "angular_backlash": "rad",
    "stiffness_ratio": "1",
    "damping_ratio": "1",
    "damping_ratio_frequency": "rad/s",
}
