"""How a loopback controller runs, and what is to go wrong with it."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from robots.interfaces import Arm


class LoopbackSettings(BaseModel):
    """Settings of a loopback controller; times are on its own clock.

    Attributes:
        port: Where it listens on this machine; 0 takes a free one.
        lockstep: Whether its time goes on by the driver's steps, not by the machine's clock.
        fresh: Whether each new driver finds time at 0, arms at home and open grippers.
        cycle_s: Between two commands to the joints, and two states.
        silence_s: It stops the arms when it has heard nothing for that long.
        overrun_s: It stops the arms when a cycle comes that late.
        latency_s: Of every message, each way.
        jitter_s: Most that chance adds to that; messages may overtake each other.
        loss: Share of messages that never arrive, each way.
        seed: Of that chance.
        cuts_s: When the connection is cut.
        stall_at_s: When it hangs; never when negative.
        stall_s: For how long.
        between_m: Width of what is between the fingers of each gripper; 0 for nothing.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    port: Annotated[int, Field(ge=0, le=65535)] = 0
    lockstep: bool = False
    fresh: bool = False
    cycle_s: Annotated[float, Field(ge=0.001, le=0.02)] = 0.004
    silence_s: Annotated[float, Field(gt=0.0, le=10.0)] = 0.5
    overrun_s: Annotated[float, Field(gt=0.0, le=10.0)] = 0.25
    latency_s: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0
    jitter_s: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0
    loss: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    seed: Annotated[int, Field(ge=0)] = 0
    cuts_s: tuple[float, ...] = ()
    stall_at_s: float = -1.0
    stall_s: Annotated[float, Field(ge=0.0)] = 0.0
    between_m: dict[Arm, float] = Field(default_factory=dict)
