"""What the page may ask: checked before anything is done about it."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

__all__ = [
    "AskCommand",
    "AskFollow",
    "AskLook",
    "AskRun",
    "AskState",
    "AskTimeline",
    "Request",
    "read_request",
]

Seconds = Annotated[float, Field(ge=0.0, le=1e9, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0, le=2**53)]


class _Ask(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    id: Count


class AskRun(_Ask):
    """The run's message, and how far it reaches."""

    ask: Literal["run"]


class AskState(_Ask):
    """Where everything was at a time."""

    ask: Literal["state"]
    at_s: Seconds


class AskFollow(_Ask):
    """What came after a time; a fresh state if that is shorter."""

    ask: Literal["follow"]
    after_s: Seconds
    until_s: Seconds


class AskTimeline(_Ask):
    """Items of the timeline from the ``begin``-th on."""

    ask: Literal["timeline"]
    begin: Count


class AskLook(_Ask):
    """A robot's tree as it is now, in the middle of a tick too; only live."""

    ask: Literal["look"]
    robot: Annotated[str, Field(max_length=200)]


class AskCommand(_Ask):
    """Something for the debugger to do; only live."""

    ask: Literal["command"]
    command: dict[str, Any]


Request = AskRun | AskState | AskFollow | AskTimeline | AskLook | AskCommand

_READER: TypeAdapter[Request] = TypeAdapter(Annotated[Request, Field(discriminator="ask")])


def read_request(text: str) -> Request:
    """A request from its JSON.

    Raises:
        ValueError: it is none.
    """
    return _READER.validate_json(text)
