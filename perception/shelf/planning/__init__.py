"""What to move next in a search of a shelf."""
