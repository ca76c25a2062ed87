"""Ticks a recorded run again without a cell: its leaves answer what the recording says."""
