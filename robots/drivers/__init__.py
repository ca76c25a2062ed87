"""Drivers of arms, by way of `robots.interfaces.ArmsDriver`: over a socket, and from a recording.

docs/drivers.md tells how to write another one. The simulated arms' is `simulation.arms_driver`.
"""
