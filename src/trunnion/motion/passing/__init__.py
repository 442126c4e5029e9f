"""Passage through resonance, or capture by it."""
