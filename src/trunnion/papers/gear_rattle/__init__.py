"""Gear rattle: what was published, what is computed."""
