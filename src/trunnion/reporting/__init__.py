"""From results to the one HTML file an engineer hands on."""
