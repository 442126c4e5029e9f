"""Is a line fit for its speeds, what helps, and how its behaviour follows its numbers."""
