"""Peaks of the steady response, bounded over ranges of speeds and tolerances."""
