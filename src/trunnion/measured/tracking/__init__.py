"""Orders of measured signals over speed."""
