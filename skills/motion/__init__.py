"""Skills that move arms and nothing else."""
