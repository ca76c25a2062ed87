"""The behaviour-tree executive: it knows no robot, no cable and no shelf."""
