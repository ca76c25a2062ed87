"""Views of a run; they read recordings and nothing else."""
