"""The accepted forms of a surface point."""

import numpy as np
import pytest

from supple import SurfacePoint, Vertex
from supple.points import point_to_wire
from supple.wire import decode


def test_each_way_of_writing_a_point_has_one_form_on_the_wire() -> None:
    in_face = {"face": 3, "barycentric": [0.25, 0.25, 0.5]}
    assert point_to_wire(SurfacePoint(3, (0.25, 0.25, 0.5))) == in_face
    assert point_to_wire((3, (0.25, 0.25, 0.5))) == in_face
    assert point_to_wire((np.int32(3), np.array([0.25, 0.25, 0.5]))) == in_face
    assert point_to_wire(7) == point_to_wire(np.int64(7)) == point_to_wire(Vertex(7)) == {"vertex": 7}


@pytest.mark.parametrize("wrong", [(3, (0.5, 0.5)), (3, (0.2, 0.3, 0.1, 0.4)), (3, (float("nan"), 0, 1)), (3,)])
def test_a_malformed_tuple_is_a_value_error(wrong: object) -> None:
    with pytest.raises(ValueError):
        point_to_wire(wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("wrong", [True, 1.5, "v7", None])
def test_what_is_no_point_at_all_is_a_type_error(wrong: object) -> None:
    with pytest.raises(TypeError):
        point_to_wire(wrong)  # type: ignore[arg-type]


def test_an_answered_point_can_be_sent_again() -> None:
    wire = {"face": 5, "barycentric": [0.1, 0.2, 0.7]}
    assert point_to_wire(decode(SurfacePoint, wire)) == wire
