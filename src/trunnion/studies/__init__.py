"""Studies of very many lines: what a point, a block and a task are, and a store in which nothing is lost."""
