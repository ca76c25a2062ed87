"""Faults that are injected into a mission on purpose, and campaigns of them."""
