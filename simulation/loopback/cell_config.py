"""What can be set about a cell whose arms are behind a socket: light to import."""

from typing import Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from simulation.loopback.settings import LoopbackSettings


class SocketCellConfig(BaseModel):
    """The cell itself.

    Attributes:
        address: `HOST:PORT` of a controller that runs already; without one, a loopback
            controller is started, and ended with the cell.
        controller: Settings of that loopback controller.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    address: str = Field(default="", pattern=r"^$|^.+:\d+$")
    controller: LoopbackSettings = LoopbackSettings(lockstep=True)

    @model_validator(mode="after")
    def _one_controller(self) -> Self:
        if self.address and "controller" in self.model_fields_set:
            raise ValueError("address names a controller that runs; try leaving controller out")
        return self
