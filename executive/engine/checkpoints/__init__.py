"""Checkpoints of a run: taken while it goes on, gone on from after it was killed."""
