"""Requests of computations: what is sent to the server, and how its answer is read."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Generic, Mapping, Optional, TypeVar, Union, get_args

from .checks import one_of
from .progress import Progress
from .transport import Answer
from .units import DURATION, Number
from .wire import LOCAL, At, Sent, decode

Result = TypeVar("Result")

Deadline = Annotated[Optional[Number], DURATION]
Timeout = Annotated[Optional[Number], LOCAL, DURATION]
Reported = Annotated[Optional[Progress], LOCAL]
Kind = Annotated[str, LOCAL]


class Resource:
    """A mesh or a model on a server.

    `id` is its id, which requests send in its place.
    """

    @property
    def id(self) -> str:
        raise NotImplementedError


def id_of(resource: Union[Resource, str], name: str = "") -> str:
    return resource if isinstance(resource, str) else resource.id


OnMesh = Annotated[Union[Resource, str], At(write=id_of)]
"""The mesh of a request."""
OfModel = Annotated[Union[Resource, str], LOCAL]
"""The model of a request, which is part of the path."""


class Request(Sent, Generic[Result]):
    """A computation that `Client.run` runs and `Client.submit` submits as a job.

    Each kind is a dataclass with fields of its own, in which None stands for the server's default. All have the fields

        deadline: seconds that the computation may take on the server, or for example "2 min" (`DeadlineExceeded`).
        timeout: seconds after which a client that waits gives up (`RequestTimeout`), or for example "30 s"; None waits without
            limit.
        progress: how a client that waits reports progress, see `Progress`; None takes that of the client.
        priority: "interactive" starts before all others, "normal", or "background", which delays no other computation of the
            server; None is normal, and interactive where the request has a session.
    """

    path: ClassVar[str]
    _result: ClassVar[Any]
    timeout: Timeout
    progress: Reported

    def __init_subclass__(cls, path: str = "", **constants: Any) -> None:
        super().__init_subclass__(**constants)
        if path:
            cls.path = path
        for base in getattr(cls, "__orig_bases__", ()):
            if get_args(base):
                cls._result = get_args(base)[0]

    @property
    def accept(self) -> str:
        """The media type of the answer."""
        return "application/json"

    def url(self) -> str:
        """The path of the computation on the server."""
        return self.path

    def decode(self, answer: Answer) -> Result:
        """The result in an answer."""
        result: Result = decode(self._result, answer.json())
        return result


class FileRequest(Request[bytes]):
    """A request whose answer is a file of the `kind` that the request names."""

    TYPES: ClassVar[Mapping[str, str]]
    kind: str

    def __post_init__(self) -> None:
        super().__post_init__()
        one_of(self.kind, "kind", tuple(self.TYPES))

    @property
    def accept(self) -> str:
        return self.TYPES[self.kind]

    def decode(self, answer: Answer) -> bytes:
        return answer.content
