"""A mission from its first tick to its last."""
