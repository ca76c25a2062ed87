"""Robot descriptions, kinematics, planning, timing and drivers."""
