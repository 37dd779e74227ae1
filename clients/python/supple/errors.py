"""The exceptions of this package.

::

    SuppleError
      ConnectionFailed         no answer: nothing listens, or the connection broke     (also a ConnectionError)
      RequestTimeout           no answer in time                                       (also a TimeoutError)
      ProblemError             the server answered with a problem
        InvalidRequest         the request cannot be fulfilled (4xx)                   (also a ValueError)
          InvalidMesh          the mesh is faulty; `faults` names the elements
          InvalidPoint         a surface point does not lie on the mesh
          InvalidNetwork       points and springs do not form a network on the mesh
          InvalidHost          a mesh or a material is not suitable for a shell or solid
          InvalidVoronoi       sites or objectives are not valid for the mesh
          InvalidStructure     a tiling's parameters give no structure
          InvalidDesign        a design problem is not valid, or no design has equilibria
          InvalidWeave         strands, crossings or loads that do not fit together
        AccessDenied           the server requires a key, or another one (401, 403)
        NotFound               no such mesh, job, family or model                      (also a LookupError)
        JobCancelled           the job was cancelled before it finished
          Superseded           a newer request of the same session replaced it
        DeadlineExceeded       the server's deadline for the computation passed
        ServerBusy             too much to do at present; try again later
        ServerError            the server failed (5xx)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Optional, Tuple, Type


class SuppleError(Exception):
    """Any failure that this package reports."""


class ConnectionFailed(SuppleError, ConnectionError):
    """There is no answer: nothing listens at the address, or the connection broke."""


class RequestTimeout(SuppleError, TimeoutError):
    """The answer did not come within the client's timeout."""


@dataclass(frozen=True)
class Fault:
    """One fault: a JSON pointer into the request or a mesh element, and what is wrong with it.

    Where more of a quantity would mend it, `needed` and `available` are the two numbers of the message, in its unit, such as the
    mm along a strand that a crossing needs to be printed.
    """

    where: str
    message: str
    needed: Optional[float] = None
    available: Optional[float] = None

    def __str__(self) -> str:
        return f"{self.where}: {self.message}" if self.where else self.message


class ProblemError(SuppleError):
    """A problem that the server reports (RFC 9457).

    Attributes:
        status: HTTP status.
        code: stable identifier such as ``mesh.non_manifold_edge``; the full table is ``api/errors.yaml``.
        title: the kind of problem.
        detail: a sentence on what is wrong in this case.
        faults: each field or mesh element at fault.
    """

    def __init__(self, status: int, code: str, title: str, detail: str, faults: Tuple[Fault, ...] = ()) -> None:
        lines = [f"{detail or title} [{code}, HTTP {status}]", *(f"  {fault}" for fault in faults)]
        super().__init__("\n".join(lines))
        self.status = status
        self.code = code
        self.title = title
        self.detail = detail
        self.faults = faults


class InvalidRequest(ProblemError, ValueError):
    """The request cannot be fulfilled and must be changed."""


class InvalidMesh(InvalidRequest):
    """The mesh is not a manifold triangle mesh; `faults` names the elements."""


class InvalidPoint(InvalidRequest):
    """A surface point does not lie on the mesh."""


class InvalidNetwork(InvalidRequest):
    """Points and springs do not form a network on the mesh; `faults` names the entries."""


class InvalidHost(InvalidRequest):
    """The mesh, a material or fixed vertices are not suitable for a shell or solid; `faults` names the entries."""


class InvalidVoronoi(InvalidRequest):
    """Sites, objectives or options of a Voronoi diagram are not valid for the mesh; `faults` names the entries."""


class InvalidStructure(InvalidRequest):
    """A tiling's parameters give no structure, or none that can be meshed; or a definition is not one of a family."""


class InvalidDesign(InvalidRequest):
    """A design problem is not valid, or no design has equilibria at all samples of its target."""


class InvalidWeave(InvalidRequest):
    """Strands, crossings or loads of a weave do not fit together; `faults` names them."""


class AccessDenied(ProblemError):
    """The server requires a key, does not accept the one that was sent, or that key lacks the permission."""


class NotFound(ProblemError, LookupError):
    """No such mesh, job, family of tilings or model."""


class JobCancelled(ProblemError):
    """The job was cancelled before it finished."""


class Superseded(JobCancelled):
    """A newer request of the same session replaced this one."""


class DeadlineExceeded(ProblemError):
    """The server's deadline for the computation passed before it finished."""


class ServerBusy(ProblemError):
    """The server has too much to do at present."""


class ServerError(ProblemError):
    """The server failed."""


_BY_CODE: Mapping[str, Type[ProblemError]] = {
    "design.superseded": Superseded,
    "job.cancelled": JobCancelled,
    "job.dismissed": JobCancelled,
    "job.deadline_exceeded": DeadlineExceeded,
}


def _class_for(status: int, code: str) -> Type[ProblemError]:
    if code in _BY_CODE:
        return _BY_CODE[code]
    if status in (401, 403):
        return AccessDenied
    if status == 404:
        return NotFound
    if status in (429, 503):
        return ServerBusy
    if status >= 500:
        return ServerError
    if code.startswith("mesh."):
        return InvalidMesh
    if code.startswith("point."):
        return InvalidPoint
    if code.startswith("network."):
        return InvalidNetwork
    if code.startswith(("host.", "solid.")):
        return InvalidHost
    if code.startswith("voronoi."):
        return InvalidVoronoi
    if code.startswith(("tiling.", "family.", "atlas.")):
        return InvalidStructure
    if code.startswith("design."):
        return InvalidDesign
    if code.startswith("weave."):
        return InvalidWeave
    return InvalidRequest


def problem_from(status: int, body: Any) -> ProblemError:
    """The exception for a problem document. `body` is the decoded JSON, or any other content of the answer."""
    document: Mapping[str, Any] = body if isinstance(body, dict) else {}
    code = str(document.get("code", "unknown"))
    title = str(document.get("title", f"HTTP status {status}"))
    detail = str(document.get("detail", ""))
    faults = tuple(
        Fault(
            str(entry.get("pointer", entry.get("where", ""))),
            str(entry.get("detail", entry.get("message", ""))),
            entry.get("needed"),
            entry.get("available"),
        )
        for entry in document.get("errors", [])
        if isinstance(entry, dict)
    )
    return _class_for(status, code)(status, code, title, detail, faults)
