"""Perturbation methods for one oscillator with a gap."""
