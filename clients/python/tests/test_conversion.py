"""Meshes of other libraries, imitated by objects with the same attributes, and the nearest points of a mesh."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

from supple import conversion
from supple.conversion import arrays_of
from supple.nearest import nearest_points
from supple.points import SurfacePoint

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=np.float64)
FACES = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
TRIMESH = SimpleNamespace(vertices=VERTICES, faces=FACES)
MESHIO = SimpleNamespace(points=VERTICES, cells_dict={"triangle": FACES, "line": FACES[:, :2]})
PYVISTA = SimpleNamespace(points=VERTICES.astype(np.float32), faces=np.array([3, 0, 1, 2, 3, 0, 2, 3]))


@pytest.mark.parametrize("mesh", [TRIMESH, MESHIO, PYVISTA], ids=["trimesh", "meshio", "pyvista"])
def test_meshes_of_other_libraries_become_arrays(mesh: Any) -> None:
    arrays = arrays_of(mesh)
    assert arrays is not None
    np.testing.assert_array_equal(arrays[0], VERTICES)
    np.testing.assert_array_equal(arrays[1], FACES)
    assert arrays[0].dtype == np.float64


def test_points_of_the_plane_lie_at_height_zero() -> None:
    arrays = arrays_of(SimpleNamespace(points=VERTICES[:, :2], cells_dict={"triangle": FACES}))
    assert arrays is not None
    np.testing.assert_array_equal(arrays[0], VERTICES)


@pytest.mark.parametrize("mesh", [
    SimpleNamespace(points=VERTICES, cells_dict={"quad": [[0, 1, 2, 3]]}),
    SimpleNamespace(points=VERTICES, cells_dict={}),
    SimpleNamespace(points=VERTICES, faces=np.array([4, 0, 1, 2, 3])),
    SimpleNamespace(points=VERTICES, faces=np.array([4, 0, 1, 2, 3, 2, 0, 1])),
    SimpleNamespace(points=VERTICES, faces=np.array([], dtype=int)),
    SimpleNamespace(vertices=VERTICES, faces=np.array([[0, 1, 2, 3]])),
])
def test_faces_that_are_no_triangles_are_refused(mesh: Any) -> None:
    with pytest.raises(ValueError, match="triangles"):
        arrays_of(mesh)


def test_anything_else_is_no_mesh() -> None:
    assert arrays_of(7) is None and arrays_of({"vertices": VERTICES}) is None


@pytest.mark.parametrize("name", ["trimesh", "meshio", "pyvista"])
def test_a_library_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ImportError, match=f"needs the library {name}"):
        getattr(conversion, "to_" + name)(VERTICES, FACES)


def test_meshes_are_handed_to_libraries_as_they_want_them(monkeypatch: pytest.MonkeyPatch) -> None:
    def stand_in(name: str, kind: str) -> None:
        library = ModuleType(name)
        setattr(library, kind, lambda *arguments, **more: (arguments, more))
        monkeypatch.setitem(sys.modules, name, library)

    stand_in("trimesh", "Trimesh")
    stand_in("meshio", "Mesh")
    stand_in("pyvista", "PolyData")
    assert conversion.to_trimesh(VERTICES, FACES)[1]["process"] is False
    assert conversion.to_meshio(VERTICES, FACES)[0][1] == [("triangle", FACES)]
    (points, corners), _ = conversion.to_pyvista(VERTICES, FACES)
    assert points is VERTICES and corners.tolist() == [3, 0, 1, 2, 3, 0, 2, 3]


def test_a_mesh_of_meshio_itself_comes_back_as_it_went(tmp_path: Path) -> None:
    import meshio

    mesh = conversion.to_meshio(VERTICES, FACES)
    mesh.write(tmp_path / "square.obj")
    for one in (mesh, meshio.read(tmp_path / "square.obj")):
        arrays = arrays_of(one)
        assert arrays is not None
        np.testing.assert_array_equal(arrays[0], VERTICES)
        np.testing.assert_array_equal(arrays[1], FACES)


@pytest.mark.parametrize("position, face, weights, distance", [
    ([0.75, 0.25, 2.0], 0, (0.25, 0.5, 0.25), 2.0),   # over a face
    ([0.5, -1.0, 0.0], 0, (0.5, 0.5, 0.0), 1.0),      # beyond an edge
    ([2.0, -1.0, 0.0], 0, (0.0, 1.0, 0.0), 2**0.5),   # beyond a corner
    ([1.5, 0.5, 0.0], 0, (0.0, 0.5, 0.5), 0.5),
    ([-1.0, 0.5, 0.0], 1, (0.5, 0.0, 0.5), 1.0),
    ([0.25, 1.5, 1.0], 1, (0.0, 0.25, 0.75), 1.25**0.5),
])
def test_the_nearest_point_of_a_square(position: Any, face: int, weights: Any, distance: float) -> None:
    (point,), places, distances = nearest_points(np.array([position]), VERTICES, FACES)
    assert isinstance(point, SurfacePoint) and point.face == face
    assert point.barycentric == pytest.approx(weights) and distances[0] == pytest.approx(distance)
    np.testing.assert_allclose(places[0], np.array(weights) @ VERTICES[FACES[face]])


def test_nearest_points_are_no_farther_than_any_sample_of_the_surface(monkeypatch: pytest.MonkeyPatch) -> None:
    from supple import nearest

    random = np.random.default_rng(5)
    vertices, faces = random.normal(size=(30, 3)), np.array([random.choice(30, 3, replace=False) for _ in range(40)], dtype=np.int32)
    positions = 2 * random.normal(size=(50, 3))
    found, places, distances = nearest_points(positions, vertices, faces)
    shares = random.dirichlet([1, 1, 1], 400)
    samples = np.einsum("si,fix->fsx", shares, vertices[faces]).reshape(-1, 3)
    for position, point, place, distance in zip(positions, found, places, distances):
        assert min(point.barycentric) >= -1e-12 and sum(point.barycentric) == pytest.approx(1)
        np.testing.assert_allclose(np.array(point.barycentric) @ vertices[faces[point.face]], place, atol=1e-12)
        assert distance == pytest.approx(np.linalg.norm(position - place))
        assert distance <= np.linalg.norm(samples - position, axis=1).min() + 1e-12
    monkeypatch.setattr(nearest, "PAIRS_AT_A_TIME", 100)  # several batches give the same
    np.testing.assert_array_equal(nearest_points(positions, vertices, faces)[2], distances)
