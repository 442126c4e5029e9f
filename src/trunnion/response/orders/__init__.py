"""Linear steady response by order."""
