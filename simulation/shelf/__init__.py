"""Shelves to search: what stands on them, how it is arranged, and a world without physics."""
