"""Two shafts and a Hooke joint: what was published, what is computed."""
