"""Checks before a request is sent, and numpy values in requests."""

from __future__ import annotations

import json
import math
import warnings
from typing import Any, Dict

import numpy as np
import pytest

import supple
from supple.transport import Transport


def test_x_and_y_one_after_the_other_are_no_direction() -> None:
    x, y = np.linspace(0, 0.2, 5), np.linspace(0, 1, 5)
    for first, second in ((x, y), (x.tolist(), y.tolist())):
        with pytest.raises(TypeError, match="column_stack"):
            supple.Target("stress_strain", first, second)  # type: ignore[arg-type]
    target = supple.Target("stress_strain", np.column_stack([x, y]))
    assert target.to_wire()["target"]["control_points"][1] == [0.05, 0.25]
    with pytest.raises(TypeError, match="direction is an angle in radians, not an array of shape"):
        supple.Target("stress_strain", np.column_stack([x, y]), y)  # type: ignore[arg-type]
    assert supple.Target("stress_strain", np.column_stack([x, y]), "45deg").direction == pytest.approx(np.pi / 4)


@pytest.mark.parametrize("make", [
    lambda angle: supple.Target("stress_strain", [(0, 0), (1, 1)], direction=angle),
    lambda angle: supple.Uniaxial(angle, [1.1]),
    lambda angle: supple.Biaxial(angle, [(1.1, 1.0)]),
    lambda angle: supple.UniaxialRequest("ih21", [0.1], angle, [1.1]),
    lambda angle: supple.ProfileRequest("stress_strain", [0.1], "IH21", direction=angle).to_wire(),
])
def test_degrees_where_radians_are_meant_are_warned_of(make: Any) -> None:
    with pytest.warns(supple.LikelyDegrees, match=r"45 .*math.radians\(45\)"):
        make(45)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        make(math.radians(45))
        make(-2 * math.pi)


@pytest.mark.parametrize("arguments, message", [
    ({"task": "stress"}, "task is 'stress'; expected one of 'stress_strain'"),
    ({"control_points": [(0, 0), (0.2, 1), (0.1, 2)]}, "control point 2 has x = 0.1"),
    ({"control_points": [(0, 0), (math.nan, 1)]}, "control point 1 is not finite"),
    ({"weights": [1]}, "weights have the shape"),
    ({"bands": [0, -1]}, "bands are finite and not negative"),
    ({"interpolation": "quadratic"}, "interpolation"),
    ({"strain_measure": "true"}, "strain_measure"),
    ({"strain": math.inf}, "strain is inf"),
])
def test_a_target_that_means_nothing_is_refused_at_once(arguments: Dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        supple.Target(**{"task": "stress_strain", "control_points": [(0, 0), (0.1, 1)], **arguments})


def test_numbers_and_arrays_of_numpy_are_sent_as_plain_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    sent: Dict[str, Any] = {}
    transport = Transport("http://127.0.0.1:1", 1)

    class Response:
        status_code, headers, content = 200, {}, b"{}"

    def request(method: str, url: str, **more: Any) -> Response:
        sent.update(json.loads(more["data"]))
        return Response()

    monkeypatch.setattr(transport._session, "request", request)
    transport.request("POST", "/", document={"a": np.float32(0.5), "b": np.int64(3), "c": np.eye(2), "d": np.bool_(True)})
    assert sent == {"a": 0.5, "b": 3, "c": [[1, 0], [0, 1]], "d": True}
    with pytest.raises(TypeError, match="cannot be sent"):
        transport.request("POST", "/", document={"a": object()})
