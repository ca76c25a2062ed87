"""Which strand lies on top: two classifiers that share the geometry and the decision."""
