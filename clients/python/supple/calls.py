"""Methods that are made from request classes, whose fields are their arguments."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any, Callable, Type, TypeVar

from .connection import Connection
from .jobs import Job, run, submit
from .request import Request, Result

if TYPE_CHECKING:
    from typing_extensions import Concatenate, ParamSpec

    Arguments = ParamSpec("Arguments")

Method = TypeVar("Method", bound=Callable[..., Any])
Owner = TypeVar("Owner")


def runs(request: Callable[Arguments, Request[Result]]) -> Callable[Concatenate[Connection, Arguments], Result]:
    """The method of a client that runs such a request."""

    def method(__client: Connection, *arguments: Arguments.args, **named: Arguments.kwargs) -> Result:
        return __client.run(request(*arguments, **named))

    return _described(method, request, "self")


def submits(request: Callable[Arguments, Request[Result]]) -> Callable[Concatenate[Connection, Arguments], Job[Result]]:
    """The method of a client that submits such a request as a job."""

    def method(__client: Connection, *arguments: Arguments.args, **named: Arguments.kwargs) -> Job[Result]:
        return __client.submit(request(*arguments, **named))

    return _described(method, request, "self")


def runs_here(request: Callable[Arguments, Request[Result]]) -> Callable[Arguments, Result]:
    """The method of a mesh or a model that runs such a request, of which it is the first field."""

    def method(*arguments: Arguments.args, **named: Arguments.kwargs) -> Result:
        resource: Any = arguments[0]
        return run(resource._transport, request(*arguments, **named))

    return _described(method, request)


def submits_here(request: Callable[Arguments, Request[Result]]) -> Callable[Arguments, Job[Result]]:
    """The method of a mesh or a model that submits such a request as a job."""

    def method(*arguments: Arguments.args, **named: Arguments.kwargs) -> Job[Result]:
        resource: Any = arguments[0]
        return submit(resource._transport, request(*arguments, **named))

    return _described(method, request)


def named(owner: Type[Owner]) -> Type[Owner]:
    """Gives those methods of a class the names that they have there, for help() and tracebacks."""
    for name, method in vars(owner).items():
        if hasattr(method, "__signature__"):
            method.__name__, method.__qualname__ = name, f"{owner.__name__}.{name}"
    return owner


def _described(method: Method, request: Any, *first: str) -> Method:
    """The method with the parameters and the text of its request, for help()."""
    own = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in first]
    fields = [field.replace(annotation=inspect.Parameter.empty) for field in inspect.signature(request).parameters.values()]
    method.__signature__ = inspect.Signature([*own, *fields])  # type: ignore[attr-defined]
    method.__doc__ = request.__doc__
    return method
