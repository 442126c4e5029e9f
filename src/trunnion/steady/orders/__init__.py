"""The linear steady state by order, without a verdict on it."""
