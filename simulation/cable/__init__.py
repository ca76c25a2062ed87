"""A cable as a rod: its physics, its knots, and what is true about it."""
