"""A controller of two arms in a process of its own, to try drivers and links on; no physics.

`python -m simulation.loopback` starts one; `robots.drivers.socket_arms.SocketArms` talks to it.
Its joints and fingers are where they are sent. Its link may be slow, lossy and cut, its cycles
may stall, all by seed and all on the controller's own clock.
"""
