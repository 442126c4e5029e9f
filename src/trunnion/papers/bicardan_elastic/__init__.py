"""An elastic bicardan transmission: what was published, what is computed."""
