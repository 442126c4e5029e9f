"""Modes of the straight line: frequencies, damping, shapes, the speeds at which joints can excite them."""
