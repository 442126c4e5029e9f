"""What would help: sensitivities, and the smallest single changes that satisfy a check."""
