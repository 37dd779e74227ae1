"""Problems become exceptions that can be told apart."""

import pytest

from supple import errors


@pytest.mark.parametrize("status, code, expected", [
    (422, "mesh.non_manifold_edge", errors.InvalidMesh),
    (413, "mesh.too_large", errors.InvalidMesh),
    (422, "point.outside_face", errors.InvalidPoint),
    (400, "request.invalid", errors.InvalidRequest),
    (422, "host.open_surface", errors.InvalidHost),
    (422, "solid.not_filled", errors.InvalidHost),
    (422, "karcher.unreachable", errors.InvalidRequest),
    (401, "access.key_required", errors.AccessDenied),
    (403, "access.scope", errors.AccessDenied),
    (429, "access.rate", errors.ServerBusy),
    (404, "mesh.not_found", errors.NotFound),
    (404, "job.not_found", errors.NotFound),
    (410, "job.cancelled", errors.JobCancelled),
    (410, "job.dismissed", errors.JobCancelled),
    (409, "design.superseded", errors.Superseded),
    (422, "voronoi.no_objective", errors.InvalidVoronoi),
    (422, "design.invalid_target", errors.InvalidDesign),
    (422, "design.no_equilibrium", errors.InvalidDesign),
    (504, "job.deadline_exceeded", errors.DeadlineExceeded),
    (503, "job.queue_full", errors.ServerBusy),
    (500, "server.internal", errors.ServerError),
    (500, "a.code_of_the_future", errors.ServerError),
])
def test_a_code_leads_to_one_class(status: int, code: str, expected: type) -> None:
    assert type(errors.problem_from(status, {"code": code, "title": "t", "detail": "d"})) is expected


def test_the_message_names_the_code_and_every_fault() -> None:
    error = errors.problem_from(422, {"code": "mesh.degenerate_face", "title": "t", "detail": "2 faces have no area",
                                      "errors": [{"pointer": "face 3", "detail": "has no area"},
                                                 {"pointer": "face 9", "detail": "repeats vertex 4"}]})
    assert str(error) == ("2 faces have no area [mesh.degenerate_face, HTTP 422]\n"
                          "  face 3: has no area\n  face 9: repeats vertex 4")
    assert [fault.where for fault in error.faults] == ["face 3", "face 9"]
    assert error.faults[0].needed is None and error.faults[0].available is None


def test_a_fault_says_how_much_is_needed() -> None:
    entry = {"pointer": "/weave/crossings/3", "detail": "strands/1 must be lifted", "needed": 3, "available": 2.25}
    (fault,) = errors.problem_from(422, {"code": "weave.not_printable", "errors": [entry]}).faults
    assert (fault.needed, fault.available) == (3, 2.25)


def test_an_answer_that_is_no_problem_document_still_becomes_an_error() -> None:
    error = errors.problem_from(502, None)
    assert isinstance(error, errors.ServerError)
    assert error.code == "unknown"


def test_the_classes_are_also_the_builtin_ones_that_callers_expect() -> None:
    assert issubclass(errors.ConnectionFailed, ConnectionError)
    assert issubclass(errors.RequestTimeout, TimeoutError)
    assert issubclass(errors.InvalidRequest, ValueError)
    assert issubclass(errors.NotFound, LookupError)
