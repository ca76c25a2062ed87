"""Ways to follow a cable: by its skeleton graph, or step by step (SGTM 2.0)."""
