"""Two lines side by side: what changed, and what it did."""
