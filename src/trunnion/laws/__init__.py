"""Kinematic laws of joints as pure functions of angle."""
