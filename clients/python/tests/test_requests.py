"""Requests that are run and submitted, and the methods that are made from them."""

from __future__ import annotations

import ast
import inspect
import json
import warnings
from pathlib import Path
from typing import Any, Callable, Dict, List, Set, Tuple

import pytest

import supple
from supple.wire import At, decode

from listener import OK, Listener

MESH = "a" * 64
LAYOUT: Dict[str, Any] = {"strands": [], "crossings": [], "lattice": None, "warnings": ["w"],
                          "cost": {"seconds": 1, "stages": [{"name": "fit", "seconds": 0.5}], "quantities": {}}}


def answer(document: Any, status: str = "200 OK", more: str = "") -> bytes:
    body = json.dumps(document)
    return f"HTTP/1.1 {status}\r\nContent-Type: application/json\r\n{more}Content-Length: {len(body)}\r\n\r\n{body}".encode()


ACCEPTED = answer({}, "202 Accepted", "Location: /v1/jobs/7\r\n")


def job(state: str, progress: float) -> bytes:
    return answer({"id": "7", "state": state, "kind": "weave-layouts", "progress": progress, "stage": "fit", "created": "t"})


def first_line(request: bytes) -> str:
    return request.split(b"\r\n")[0].decode()


def test_a_request_is_run_with_its_progress(listen: Callable[..., Listener]) -> None:
    listener = listen([ACCEPTED, job("running", 0.5), job("successful", 1), answer(LAYOUT)])
    seen: List[Tuple[float, str]] = []
    request = supple.WeaveLayoutRequest(supple.Weave.rings(), progress=lambda fraction, stage: seen.append((fraction, stage)))
    with supple.Client(listener.url) as client:
        layout = client.run(request)
    assert isinstance(layout, supple.WeaveLayout) and layout.warnings == ("w",) and layout.cost.stages == {"fit": 0.5}
    assert seen == [(0.5, "fit"), (1, "fit")]
    assert b"Prefer: wait=1" in listener.requests[0]


def test_a_submitted_request_is_a_job_that_waits_as_long_as_the_request_says(listen: Callable[..., Listener]) -> None:
    listener = listen([ACCEPTED, job("running", 0.5), ACCEPTED])
    with supple.Client(listener.url) as client:
        submitted = client.submit(supple.WeaveLayoutRequest(supple.Weave.rings(), timeout=0.01))
        assert submitted.id == "7" and b"Prefer: respond-async" in listener.requests[0]
        with pytest.raises(supple.RequestTimeout):
            submitted.result()
        assert client.start_weave_homogenization(supple.Weave.rings(), strain=0.2).id == "7"
    assert first_line(listener.requests[2]) == "POST /v1/weave-homogenizations HTTP/1.1"


def test_a_request_names_its_priority_and_its_job_tells_it_and_the_remaining_time(listen: Callable[..., Listener]) -> None:
    document = {"id": "7", "state": "running", "kind": "weave-homogenizations", "progress": 0.5, "stage": "fit", "created": "t",
                "priority": "background", "remaining_seconds": 2.5}
    listener = listen([ACCEPTED, answer(document), answer({**document, "remaining_seconds": None}), job("running", 0.5)])
    with supple.Client(listener.url) as client:
        submitted = client.start_weave_homogenization(supple.Weave.rings(), strain=0.2, priority="background")
        status = submitted.status()
        assert (status.priority, status.remaining_seconds) == ("background", 2.5)
        assert submitted.remaining_seconds is None
        assert submitted.status().priority == "normal", "of a server that does not know priorities"
    assert json.loads(listener.requests[0].split(b"\r\n\r\n", 1)[1])["priority"] == "background"
    assert "priority" not in supple.FieldRequest(MESH, [0]).to_wire()


def test_a_method_has_the_fields_of_its_request_as_arguments() -> None:
    assert list(inspect.signature(supple.Client.simulate).parameters)[:4] == ["self", "family", "parameters", "load"]
    with supple.Client("http://127.0.0.1:9") as client:
        assert list(inspect.signature(client.simulate).parameters)[0] == "family"
        with pytest.raises(TypeError, match="famly"):
            client.structure(famly="IH21")  # type: ignore[call-arg]
    assert supple.Client.simulate.__doc__ == supple.SimulationRequest.__doc__
    assert supple.Mesh.start_field.__qualname__ == "Mesh.start_field"  # type: ignore[attr-defined]


def test_a_request_takes_a_mesh_or_its_id() -> None:
    class Known(supple.request.Resource):
        id = MESH

    assert supple.FieldRequest(Known(), [0]).to_wire() == supple.FieldRequest(MESH, [0]).to_wire()


def test_queries_and_ids_are_escaped(listen: Callable[..., Listener]) -> None:
    family = "a/../b?c"
    listener = listen([answer({"jobs": [], "next": "x&state=y z"}), answer({"jobs": []}), OK, OK])
    with supple.Client(listener.url) as client:
        assert list(client.jobs("a&b=c")) == []
        for ask in (lambda: client.family(family), lambda: client.mesh(family)):
            with pytest.raises(KeyError):
                ask()
    assert [first_line(request) for request in listener.requests] == [
        "GET /v1/jobs?state=a%26b%3Dc HTTP/1.1", "GET /v1/jobs?state=a%26b%3Dc&after=x%26state%3Dy+z HTTP/1.1",
        "GET /v1/families/a%2F..%2Fb%3Fc HTTP/1.1", "GET /v1/meshes/a%2F..%2Fb%3Fc HTTP/1.1"]


def test_an_answer_that_lacks_a_required_member_is_an_error() -> None:
    with pytest.raises(KeyError, match="cost"):
        decode(supple.WeaveLayout, {name: value for name, value in LAYOUT.items() if name != "cost"})


def test_a_warning_points_at_the_line_that_called_the_package() -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        supple.Uniaxial(90, [1.1])
        supple.DesignRequest(supple.Target("poisson", [(0, 0), (1, 1)]), orientation=90.0).to_wire()
    assert [Path(warning.filename).name for warning in caught] == ["test_requests.py"] * 2


def test_a_pointer_goes_on_with_the_name_of_the_field() -> None:
    assert At("/accuracy/").parts("tolerance") == ["accuracy", "tolerance"] and At().parts("x") == ["x"]
    assert At("").parts("x") == [] and At("/states/*/").parts("x") == ["states", "*", "x"]


def test_no_module_needs_one_that_needs_it() -> None:
    folder = Path(supple.__file__).parent
    used: Dict[str, Set[str]] = {}
    for path in folder.glob("*.py"):
        nodes = [node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.ImportFrom)]
        local = [node for node in nodes if node.level == 1]
        used[path.stem] = {node.module for node in local if node.module} | {
            name.name for node in local if not node.module for name in node.names}
    order: List[str] = []
    while len(order) < len(used):
        free = [name for name, needs in used.items() if name not in order and needs <= set(order)]
        assert free, f"a circle of imports among {sorted(set(used) - set(order))}"
        order += free
    assert order[-1] == "__init__"
