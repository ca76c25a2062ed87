"""Models that score which object stands beside which; only building affinities needs them."""
