"""From a goal of a tool to a checked trajectory: kinematics, collisions, paths, timing."""
