"""A periodic linear system over one period."""
