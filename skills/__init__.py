"""Leaves of the trees, one skill a file; they talk to interfaces, never to a simulator."""
