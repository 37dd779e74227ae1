"""The Python package with a real server."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from typing import Any, List, Tuple

import numpy as np
import pytest

import supple
from contract import ROOT
from harness import Api, free_port
from shapes import bumpy_sphere, flat_grid, obj_text, sphere, two_triangles_apart
from working_time import PATIENCE_SECONDS, ends_within

EXAMPLES = sorted((ROOT / "clients" / "python" / "examples").glob("*.py"))


def test_a_mesh_is_uploaded_from_a_file_from_bytes_and_from_arrays(client: supple.Client, tmp_path: Path) -> None:
    vertices, faces = flat_grid(4, 3.0)
    (tmp_path / "grid.obj").write_text(obj_text((vertices, faces)))
    meshes = [client.upload(tmp_path / "grid.obj"), client.upload(obj_text((vertices, faces)).encode()),
              client.upload_arrays(vertices, faces)]
    assert len({mesh.id for mesh in meshes}) == 1
    info = meshes[0].info
    assert (info.vertices, info.faces, info.boundary_loops, info.upper) == (25, 32, 1, (3, 3, 0))
    assert client.mesh(info.id).info == info
    assert info.id in [listed.id for listed in client.meshes()]
    positions, corners = meshes[0].arrays()
    np.testing.assert_array_equal(positions, vertices)
    np.testing.assert_array_equal(corners, faces)


def test_a_faulty_mesh_is_repaired_and_its_places_are_known(client: supple.Client) -> None:
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [1e-5, 0, 0], [5, 5, 5]]
    faces = [[0, 1, 2], [5, 3, 4], [0, 1, 1], [1, 6, 6]]
    content = "".join(f"v {x} {y} {z}\n" for x, y, z in vertices) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)
    options: Any = {"repair": ["weld", "drop_degenerate", "split_non_manifold"], "weld_tolerance": 1e-5}
    for mesh in (client.upload_arrays(vertices, faces, **options), client.upload(content.encode(), **options)):
        assert mesh.repair is not None
        assert (mesh.repair.welded_vertices, mesh.repair.dropped_degenerate_faces, mesh.repair.split_vertices,
                mesh.repair.removed_vertices) == (1, 2, 1, 1)
        assert mesh.repair.vertices == ((0,), (1,), (2,), (3,), (4,), (5,), ())
        assert mesh.repair.faces.tolist() == [0, 1, -1, -1]
        np.testing.assert_array_equal(mesh.arrays()[0][5], [0, 0, 0])
    assert client.mesh(mesh.id).repair is None
    with pytest.raises(supple.InvalidMesh):
        client.upload_arrays(vertices, faces)
    with pytest.raises(TypeError):
        client.upload_arrays(vertices, faces, repair="weld")


def test_a_deleted_mesh_is_not_found(client: supple.Client) -> None:
    mesh = client.upload_arrays(*flat_grid(2, 9.75))
    mesh.delete()
    with pytest.raises(supple.NotFound) as error:
        client.mesh(mesh.id)
    assert error.value.code == "mesh.not_found"


def test_geodesics_have_distances_derivatives_and_paths(client: supple.Client) -> None:
    mesh = client.upload_arrays(*flat_grid(8))
    geodesic = mesh.geodesic(0, 80, derivatives=2, path=True)
    assert geodesic.distance == pytest.approx(2**0.5)
    assert geodesic.path is not None and geodesic.path.length() == pytest.approx(2**0.5)
    assert geodesic.gradient is not None and geodesic.hessian is not None and geodesic.frames is not None
    assert geodesic.gradient.tangent.shape == (4,) and geodesic.hessian.barycentric.shape == (6, 6)
    along = geodesic.gradient.tangent[2:] @ geodesic.frames[1]
    np.testing.assert_allclose(along, np.array([1, 1, 0]) / 2**0.5, atol=1e-12)
    several = mesh.geodesics([(0, 8), (supple.Vertex(0), (0, (0.2, 0.3, 0.5)))])
    assert [g.distance for g in several][0] == pytest.approx(1)
    assert several[0].path is None and several[0].gradient is None


def test_unreachable_points_have_an_infinite_distance(client: supple.Client) -> None:
    mesh = client.upload_arrays(*two_triangles_apart())
    assert mesh.geodesic(0, 3) == supple.Geodesic(float("inf"), True)
    np.testing.assert_array_equal(np.isinf(mesh.field([0]).distances), [False] * 3 + [True] * 3)


def test_a_field_is_a_writable_array(client: supple.Client) -> None:
    vertices, faces = flat_grid(8)
    field = client.upload_arrays(vertices, faces).field([7, (3, (0.2, 0.3, 0.5))])
    sources = np.stack([vertices[7], np.array([0.2, 0.3, 0.5]) @ vertices[faces[3]]])
    expected = np.linalg.norm(vertices[:, None] - sources[None], axis=2).min(axis=1)
    np.testing.assert_allclose(field.distances, expected, atol=1e-12)
    assert field.relative_error_bound == 0 and field.method == "windows" and field.seconds > 0
    field.distances[0] = 1


def test_a_mean_has_its_position_history_and_bill(client: supple.Client) -> None:
    vertices, faces = flat_grid(8)
    mean = client.upload_arrays(vertices, faces).karcher_mean([0, 80, 30], weights=[1, 2, 1])
    np.testing.assert_allclose(mean.position, np.average(vertices[[0, 80, 30]], axis=0, weights=[1, 2, 1]), atol=1e-8)
    assert mean.converged and mean.gradient_norm <= mean.gradient_tolerance
    assert len(mean.history) == mean.iterations + 1
    assert mean.cost.seconds > 0 and {effect.name for effect in mean.effects} >= {"kept_fields"}


def test_a_network_is_relaxed_with_its_paths_history_and_bill(client: supple.Client) -> None:
    vertices, faces = flat_grid(8)
    mesh = client.upload_arrays(vertices, faces)
    springs = [supple.Spring(0, 3, weight=1), supple.Spring(1, 3, weight=2), (2, 3)]
    network = mesh.relax_network([0, 80, 30, (5, (0.2, 0.3, 0.5))], springs, [0, 1, 2], paths=True)
    expected = np.average(vertices[[0, 80, 30]], axis=0, weights=[1, 2, 1])
    np.testing.assert_allclose(network.positions[3], expected, atol=1e-8)
    assert network.converged and network.gradient_norm <= network.gradient_tolerance
    assert network.paths is not None
    np.testing.assert_allclose([path.length() for path in network.paths], network.lengths, rtol=1e-9)
    assert len(network.history) == network.iterations + 1 and network.cost.seconds > 0
    assert network.terms == {"geodesic_springs": network.energy}
    assert {effect.name for effect in network.effects} >= {"geodesic_springs", "mollifier", "kept_strips"}


def test_a_membrane_is_relaxed_with_its_stretches(client: supple.Client) -> None:
    mesh = client.upload_arrays(*flat_grid(8))
    membrane = supple.Membrane([(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)], youngs_modulus=2, rest_scale=0.8)
    answer = mesh.relax_network([0, 8, 80, 72, 31], [], [0, 1, 2, 3], membrane=membrane)
    assert answer.converged and answer.stretches is not None and answer.triangle_energies is not None
    np.testing.assert_allclose(answer.stretches, 1.25, rtol=1e-6)
    assert answer.triangle_energies.sum() == pytest.approx(answer.energy)
    assert b"greater_stretch" in mesh.relaxed_network_file([0, 8, 80, 72, 31], [], [0, 1, 2, 3], kind="vtu", membrane=membrane)


def test_a_network_pulls_at_a_shell_and_at_a_solid(client: supple.Client) -> None:
    vertices, faces = sphere(2)
    mesh = client.upload_arrays(vertices, faces)
    bottom = np.flatnonzero(vertices[:, 2] < -0.7)
    points, springs, fixed = [0, 5, 1, 9], [supple.Spring(0, 1, 0.5), supple.Spring(1, 3, 0.5), (1, 2)], [0]
    shell = supple.Shell(0.02, youngs_modulus=1e3, poisson_ratio=0.4, volume_weight=1e3, volume_scale=1.05)
    answer = mesh.relax_network(points, springs, fixed, host=shell)
    assert answer.converged and answer.host is not None and answer.host.tetrahedra is None
    assert answer.host.volume_ratio == pytest.approx(1.05, rel=0.1)
    way = np.linalg.norm(answer.host.vertices - vertices, axis=1)
    assert way.max() == pytest.approx(answer.host.largest_displacement)
    assert set(answer.terms) == {"geodesic_springs", "shell_membrane", "shell_bending", "shell_volume"}
    assert sum(answer.terms.values()) == pytest.approx(answer.energy)
    flat = mesh.relax_network(points, springs, fixed, host=shell, options=supple.RelaxationOptions(bending="off"))
    assert "shell_bending" not in flat.terms
    solid = supple.Solid(100, gravity=(0, 0, -5), fixed_vertices=bottom.tolist(),
                         regions=[supple.SolidRegion((-2, -2, 0.3), (2, 2, 2), youngs_modulus=20)])
    sagging = mesh.relax_network(points, springs, fixed, host=solid)
    assert sagging.converged and sagging.host is not None and (sagging.host.tetrahedra or 0) > 100
    assert (sagging.host.nodes or 0) > len(vertices) and set(sagging.terms) == {"geodesic_springs", "solid", "gravity"}
    np.testing.assert_array_equal(sagging.host.vertices[bottom], vertices[bottom])
    assert sagging.host.vertices[:, 2].mean() < vertices[:, 2].mean()
    assert mesh.relax_network(points, springs, fixed).host is None
    assert b"o host" in mesh.relaxed_network_file(points, springs, fixed, host=shell)
    job = mesh.start_relax_network(points, springs, fixed, host=shell)
    assert job.result().host is not None
    with pytest.raises(supple.InvalidHost) as unsupported:
        mesh.relax_network(points, springs, fixed, host=supple.Solid(100, gravity=(0, 0, -5)))
    assert unsupported.value.code == "host.unsupported"


def test_a_network_follows_a_moving_surface(client: supple.Client) -> None:
    vertices, faces = flat_grid(8)
    positions = [vertices + [0, 0, height] for height in (1, 2)]
    springs = [(0, 2), (1, 2)]
    answer = client.upload_arrays(vertices, faces).relax_network([0, 80, 30], springs, [0, 1], host=supple.Moving(positions))
    assert answer.host is not None and answer.host.stops is not None and len(answer.host.stops) == 2
    assert [stop.stopped for stop in answer.host.stops] == ["converged"] * 2
    np.testing.assert_allclose(answer.host.vertices, positions[1], atol=1e-12)
    np.testing.assert_allclose(answer.positions[2], [0.5, 0.5, 2], atol=1e-7)


def test_networks_are_built_followed_and_written_as_files(client: supple.Client) -> None:
    mesh = client.upload_arrays(*bumpy_sphere(3))
    dual = mesh.relax_network(supple.PoissonDisk(0.6), supple.VoronoiDual(0.3), options=supple.RelaxationOptions(max_iterations=2))
    assert dual.triangles is not None and dual.paths is None and dual.springs.shape == (len(dual.lengths), 2)
    options = supple.RelaxationOptions(method="gradient_descent", tolerance=1e-14, max_iterations=100_000)
    job = mesh.start_relax_network(supple.PointsInFaces(), supple.AdjacentFaces(0.01), options=options)
    end = time.monotonic() + PATIENCE_SECONDS
    while (partial := job.status().partial) is None:
        assert time.monotonic() < end, "no intermediate state came"
        time.sleep(0.02)
    job.cancel()
    assert isinstance(partial, supple.PartialRelaxation) and partial.positions is not None
    assert partial.positions.shape == (mesh.info.faces, 3)
    vtu = mesh.relaxed_network_file([0, 30], [(0, 1)], [0, 1], kind="vtu")
    assert vtu.startswith(b"<?xml") and b'NumberOfCells="1"' in vtu


def test_an_exponential_map_ends_where_it_should(client: supple.Client) -> None:
    vertices, faces = flat_grid(8)
    answer = client.upload_arrays(vertices, faces).exponential_map(40, [0.1, 0.2, 0.0])
    np.testing.assert_allclose(answer.position, vertices[40] + [0.1, 0.2, 0], atol=1e-12)
    assert answer.trace is not None and answer.trace.length() == pytest.approx(answer.length)


def test_each_failure_is_an_exception_of_its_own(client: supple.Client) -> None:
    mesh = client.upload_arrays(*flat_grid(4))
    with pytest.raises(supple.InvalidPoint) as point:
        mesh.geodesic(0, 10_000)
    assert point.value.code == "point.vertex_out_of_range" and point.value.faults[0].where == "/pairs/0/to"
    with pytest.raises(supple.InvalidMesh) as faulty:
        client.upload_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 1]])
    assert faulty.value.faults[0].where == "face 0"
    with pytest.raises(supple.InvalidNetwork) as network:
        mesh.relax_network([0, 1], [(0, 1), (0, 2)])
    assert network.value.faults[0].where == "/springs/1/between/1"
    with pytest.raises(supple.InvalidRequest):
        mesh.karcher_mean([0, 1], weights=[0, 0])
    with pytest.raises(ValueError):
        client.upload_arrays(np.zeros((3, 2)), np.zeros((1, 3), int))


def test_a_deadline_is_an_exception_of_its_own(client: supple.Client) -> None:
    mesh = client.upload_arrays(*bumpy_sphere(6))
    with pytest.raises(supple.DeadlineExceeded):
        mesh.field([0], deadline=0.01)


def test_a_job_reports_progress_and_gives_the_same_result(client: supple.Client) -> None:
    mesh = client.upload_arrays(*sphere(4))
    seen: List[Tuple[float, str]] = []
    job = mesh.start_field([0])
    field = job.result(progress=lambda fraction, stage: seen.append((fraction, stage)))
    assert seen[-1][0] == 1
    np.testing.assert_array_equal(field.distances, mesh.field([0]).distances)
    status = job.status()
    assert status.finished and status.state == "successful" and status.mesh == mesh.id
    assert job.id in [listed.id for listed in client.jobs("successful")]
    assert len(client.job(job.id).result()) == 8 * mesh.info.vertices


def test_a_cancelled_job_raises(client: supple.Client) -> None:
    mesh = client.upload_arrays(*bumpy_sphere(7))
    job = mesh.start_field([0])
    with pytest.raises(supple.RequestTimeout):
        job.wait(timeout=0.1)
    job.cancel()
    with pytest.raises(supple.JobCancelled):
        job.result(timeout=PATIENCE_SECONDS)


def test_whatever_interrupts_a_waiting_call_cancels_its_computation(client: supple.Client, api: Api) -> None:
    mesh = client.upload_arrays(*bumpy_sphere(7))

    class Enough(Exception):
        pass

    def stop(fraction: float, stage: str) -> None:
        raise Enough

    with pytest.raises(Enough):
        mesh.field([0], progress=stop)
    ends_within(api.server.pid, api.busy, 2, "the computation goes on")


def test_a_missing_server_is_a_connection_error() -> None:
    with supple.Client(f"http://127.0.0.1:{free_port()}", timeout=2) as client:
        assert client.ready() is False
        with pytest.raises(ConnectionError):
            client.mesh("0" * 64)


def test_a_living_server_is_ready(client: supple.Client) -> None:
    assert client.ready() is True


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_the_example_runs(api: Api, tmp_path: Path, script: Path) -> None:
    (tmp_path / "mesh.obj").write_text(obj_text(bumpy_sphere(3)))
    arguments = [str(tmp_path / "mesh.obj")] if "MESH_FILE" in script.read_text() else []
    finished = subprocess.run([sys.executable, str(script), *arguments], capture_output=True, text=True,
                              env={"PYTHONPATH": str(ROOT / "clients" / "python"), "SUPPLE_SERVER": api.server.url},
                              timeout=60, check=False)
    assert finished.returncode == 0, finished.stderr
    assert finished.stdout
