"""Pages of the site that the package itself writes: elements, functions, commands, messages, validation."""
