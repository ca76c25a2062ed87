"""Simulated worlds; what is true in them is for scoring only."""
