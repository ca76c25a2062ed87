"""Shelves to search: what stands on them and how it is arranged, and a fast world without physics."""
