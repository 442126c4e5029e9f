"""What tolerances of a description do to stability: how probable, how bad, which matter, and what can be proved."""
