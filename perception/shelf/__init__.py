"""A shelf seen from the front: what stands on it, and where a hidden target may be."""
