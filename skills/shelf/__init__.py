"""Skills that search a shelf."""
