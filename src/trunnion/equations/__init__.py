"""From a description of a driveline to equations of motion."""
