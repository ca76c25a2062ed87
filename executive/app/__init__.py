"""The composition root: the only place that picks worlds, drivers and perception."""
