"""Periodic steady states: the base that stability, responses and motions stand on."""
