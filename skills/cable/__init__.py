"""Skills that look at a cable and act on it."""
