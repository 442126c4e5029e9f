"""Three shafts and two Hooke joints: what was published, what is computed."""
