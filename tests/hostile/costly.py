"""The costliest requests that the contract's limits permit, for each operation that computes or reads a large body.

Each is a function of the uploaded meshes and returns a method, a path, headers and a body. Large bodies are generated, so
that the tests need no files.
"""

from __future__ import annotations

import json
import math
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from contract import ROOT
from shapes import bumpy_sphere, flat_grid, sphere


class Costly(NamedTuple):
    method: str
    path: str
    body: bytes
    content_type: str = "application/json"
    accept: str = "*/*"


Meshes = Dict[str, str]
CASES: "Dict[str, Callable[[Meshes, Dict[str, Any]], Costly]]" = {}
"""Name -> function that returns the request. Its second argument has fields that every body may have, such as a deadline."""


def costly(make: "Callable[[Meshes, Dict[str, Any]], Costly]") -> "Callable[[Meshes, Dict[str, Any]], Costly]":
    CASES[make.__name__] = make
    return make


def post(path: str, document: Dict[str, Any], accept: str = "*/*") -> Costly:
    return Costly("POST", path, json.dumps(document).encode(), accept=accept)


def ply(vertices: np.ndarray, faces: np.ndarray) -> bytes:
    """The mesh as binary little-endian PLY."""
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty double x\nproperty double y\n"
            f"property double z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    rows = np.zeros(len(faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
    rows["n"], rows["v"] = 3, faces
    return head.encode() + vertices.astype("<f8").tobytes() + rows.tobytes()


def obj(vertices: np.ndarray, faces: np.ndarray) -> bytes:
    return ("".join("v %r %r %r\n" % tuple(v) for v in vertices.tolist())
            + "".join("f %d %d %d\n" % tuple(f) for f in (faces + 1).tolist())).encode()


def stl(vertices: np.ndarray, faces: np.ndarray) -> bytes:
    rows = np.zeros(len(faces), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    rows["v"] = vertices[faces]
    return b"\0" * 80 + np.uint32(len(faces)).tobytes() + rows.tobytes()


def read_obj(name: str) -> "Tuple[np.ndarray, np.ndarray]":
    """Vertices and faces of a mesh in the contract's examples."""
    lines = [line.split() for line in (ROOT / "api" / "examples" / "meshes" / f"{name}.obj").read_text(encoding="utf-8").splitlines()]
    vertices = np.array([line[1:4] for line in lines if line and line[0] == "v"], dtype=float)
    faces = np.array([[int(corner.split("/")[0]) - 1 for corner in line[1:4]] for line in lines if line and line[0] == "f"])
    return vertices, faces


LOOSE = 60_000
"""Number of triangles in a mesh of separate triangles."""


def meshes_of(upload: Callable[[bytes], str]) -> Meshes:
    """Uploads the meshes for the requests."""
    x, y = np.meshgrid(np.linspace(0, 1, 701), np.linspace(0, 1, 701), indexing="ij")
    vertices, faces = flat_grid(700)
    hills = vertices.copy()
    hills[:, 2] = (0.02 * np.sin(60 * x) * np.cos(50 * y)).ravel()
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    sides = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    triangles = np.arange(3 * LOOSE).reshape(LOOSE, 3)
    scattered = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])[triangles % 3] + np.arange(LOOSE)[:, None, None] * [2, 0, 0]
    return {"hills": upload(ply(hills, faces)), "bumpy": upload(ply(*bumpy_sphere(6))), "ball": upload(ply(*sphere(4))),
            "small": upload(ply(*bumpy_sphere(4))), "tetrahedron": upload(ply(corners, sides)),
            "needle": upload(ply(corners * [1, 1, 1e12], sides)), "cushion": upload(ply(*read_obj("cushion"))),
            "loose": upload(ply(scattered.reshape(-1, 3), triangles))}


# --- meshes --------------------------------------------------------------------------------------------------------------

GRID = 1500
"""Cells along each side of an uploaded mesh, which has 4.5 million faces."""


@costly
def upload_of_a_large_ply(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return Costly("POST", "/v1/meshes", ply(*flat_grid(GRID)), "model/ply")


@costly
def upload_of_a_large_stl(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return Costly("POST", "/v1/meshes", stl(*flat_grid(GRID)), "model/stl")


@costly
def upload_of_a_large_obj(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return Costly("POST", "/v1/meshes", obj(*flat_grid(900)), "model/obj")


@costly
def repair_of_a_large_soup(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    vertices, faces = flat_grid(GRID)
    return Costly("POST", "/v1/meshes?repair=weld,drop_degenerate,drop_duplicates,split_non_manifold&weld_tolerance=0.0005",
                  ply(vertices, faces), "model/ply")


@costly
def upload_of_one_polygon_of_many_corners(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    corners = 4096
    count = 300
    lines = []
    for k in range(count):
        for i in range(corners):
            radius = 1 + 0.5 * (i % 2)
            angle = 2 * math.pi * i / corners
            lines.append("v %r %r %r" % (radius * math.cos(angle), radius * math.sin(angle), 3.0 * k))
    for k in range(count):
        lines.append("f " + " ".join(str(k * corners + i + 1) for i in range(corners)))
    return Costly("POST", "/v1/meshes", ("\n".join(lines) + "\n").encode(), "model/obj")


@costly
def upload_of_large_json(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    vertices, faces = flat_grid(760)
    document = {"vertices": np.round(vertices, 3).tolist(), "faces": faces.tolist()}
    return post("/v1/meshes", document)


@costly
def upload_of_a_ply_of_skipped_lists(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    count = 100_000_000
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty double x\nproperty double y\nproperty double z\n"
            f"element other {count}\nproperty list uchar uchar values\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n")
    return Costly("POST", "/v1/meshes", head.encode() + bytes(count), "model/ply")


# --- geodesics -----------------------------------------------------------------------------------------------------------

def random_points(count: int, faces: int, seed: int = 1) -> List[Any]:
    choice = np.random.default_rng(seed).integers(0, faces, count)
    return [{"face": int(f), "barycentric": [0.25, 0.25, 0.5]} for f in choice]


HILLS = 2 * 700 * 700
BUMPY = 20 * 4**6
BALL = 20 * 4**4


@costly
def geodesics_of_many_far_pairs(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    points = random_points(40_000, HILLS)
    pairs = [{"from": points[i], "to": points[i + 1]} for i in range(0, len(points), 2)]
    return post("/v1/geodesics", {"mesh": meshes["hills"], "pairs": pairs, "derivatives": 2, "paths": True, **more})


@costly
def geodesics_along_long_known_paths(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    row = [{"vertex": 701 * i + 3} for i in range(701)]
    pairs = [{"from": row[0], "to": row[-1], "known_path": row} for _ in range(1400)]
    return post("/v1/geodesics", {"mesh": meshes["hills"], "pairs": pairs, **more})


@costly
def field_of_many_sources(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/geodesic-fields", {"mesh": meshes["hills"], "sources": random_points(100_000, HILLS), **more})


@costly
def field_of_one_source(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/geodesic-fields", {"mesh": meshes["hills"], "sources": [{"vertex": 0}], **more})


@costly
def mean_of_many_points(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/karcher-means", {"mesh": meshes["bumpy"], "points": random_points(100_000, BUMPY), "tolerance": 1e-15,
                                      "starts": 1000, "max_iterations": 100_000, **more})


@costly
def mean_of_two_points_on_a_large_mesh(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/karcher-means", {"mesh": meshes["hills"], "points": [{"vertex": 0}, {"vertex": 701 * 701 - 1}],
                                      "tolerance": 1e-15, "max_iterations": 100_000, "method": "gradient_descent", **more})


@costly
def exponential_map_around_and_around(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/exponential-maps", {"mesh": meshes["bumpy"], "start": {"face": 5, "barycentric": [0.3, 0.3, 0.4]},
                                         "tangent": [1e12, 0.7e12], "trace": False, **more})


@costly
def part_of_many_tiles_and_regions(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    comb = [point for i in range(40) for point in ([5 * i, 1], [5 * i, 195 + i / 50], [5 * i + 1, 195 + i / 50], [5 * i + 1, 1])] + [[200, 1], [200, 0], [0, 0]]
    regions = [{"outline": [[x + k / 50, y + k / 50] for x, y in comb], "structure": {"family": "IH50"}, "beam_width": 0.3} for k in range(20)]
    return post("/v1/parts", {"outline": {"rectangle": [200, 200]}, "structure": {"family": "IH01"}, "regions": regions, "frame": 1, **more},
                accept="model/stl")


@costly
def drawing_of_many_splines(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    spline = "0\nSPLINE\n71\n25\n" + "40\n0\n" * 26 + "40\n1\n" * 26 + "".join(f"10\n{k % 5}\n20\n{k % 7}\n" for k in range(26))
    text = "0\nSECTION\n2\nENTITIES\n" + spline * 12_000 + "0\nENDSEC\n0\nEOF\n"
    return post("/v1/outlines", {"text": text, "width": 100, "accuracy": {"tolerance": 1e-4}, **more})


@costly
def drawing_of_many_elements(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/outlines", {"text": "<svg>" + "<g/>" * 2_400_000 + "</svg>", **more})


@costly
def drawing_that_repeats_itself(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    # Ten levels, each with ten uses of the level below. The limit of the number of curves refuses it; each curve is as long as
    # permitted.
    path = '<path id="l0" d="M0 0' + "h1" * 70 + 'V9Z"/>'
    levels = "".join(f'<g id="l{k}">' + f'<use href="#l{k - 1}" x="{k}"/>' * 10 + "</g>" for k in range(1, 11))
    return post("/v1/outlines", {"text": f'<svg><defs>{path}{levels}</defs><use href="#l10"/></svg>', **more})


@costly
def measured_curve_of_many_rows(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    rows = "\n".join(f"{i * 3e-7:.7g},{i % 977}" for i in range(1_000_000))
    return post("/v1/measured-curves", {"text": rows, "units": {"x": "1", "y": "kPa"}, "interpolation": "monotone",
                                        "accuracy": {"tolerance": 1e-9, "max_control_points": 64}, **more})


@costly
def drawing_of_an_element_of_many_attributes(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    attributes = " ".join(f'a{k}=""' for k in range(500_000))
    uses = '<use href="#r"/>' * 4090
    return post("/v1/outlines", {"text": f'<svg><defs><rect id="r" width="9" height="9" {attributes}/></defs>{uses}</svg>', **more})


def texts_of_one_hash(count: int) -> List[str]:
    """Texts of 16 bytes that have the same hash in libstdc++ (MurmurHash64A). The first half is arbitrary and determines the
    second."""
    factor = 0xC6A4A7935BD1E995
    inverse = pow(factor, -1, 2**64)
    generator = np.random.default_rng(1)
    allowed = np.array([byte not in b'\0\t\n\r"&<' for byte in range(128)] + [False] * 128)
    found: List[str] = []
    mix = lambda value: value ^ (value >> np.uint64(47))  # noqa: E731
    with np.errstate(over="ignore"):
        start = np.uint64(0xC70F6907) ^ (np.uint64(16) * np.uint64(factor))
        while len(found) < count:
            first = generator.integers(35, 59, (1_000_000, 8), dtype=np.uint8)
            block = mix(first.view(np.uint64)[:, 0] * np.uint64(factor)) * np.uint64(factor)
            hashed = (start ^ block) * np.uint64(factor)
            second = mix((hashed ^ np.uint64(1)) * np.uint64(inverse)) * np.uint64(inverse)
            both = np.hstack([first, second[:, None].view(np.uint8)])
            found += [bytes(row).decode() for row in both[allowed[both].all(axis=1)]]
    return found[:count]


@costly
def drawing_of_many_ids_of_one_hash(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    ids = "".join(f'<g id="{text}"/>' for text in texts_of_one_hash(60_000))
    return post("/v1/outlines", {"text": f'<svg>{ids}<use href="#nothing"/></svg>', **more})


# --- networks ------------------------------------------------------------------------------------------------------------

@costly
def network_of_poisson_disk_points(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/embedded-systems", {"mesh": meshes["bumpy"], "points": {"kind": "poisson_disk", "radius": 0.03},
                                         "springs": {"kind": "voronoi_dual"}, "max_iterations": 100_000,
                                         "accuracy": {"tolerance": 1e-15}, **more})


@costly
def network_of_many_springs(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/embedded-systems", {"mesh": meshes["bumpy"], "points": {"kind": "per_face", "barycentric": [0.2, 0.3, 0.5]},
                                         "springs": {"kind": "adjacent_faces", "rest_length": 0.5},
                                         "max_iterations": 100_000, "accuracy": {"tolerance": 1e-15}, **more})


@costly
def network_of_long_springs(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    points = random_points(20_000, HILLS)
    springs = [{"between": [i, (i * 7919 + 1) % len(points)], "rest_length": 0.01} for i in range(1, len(points))]
    return post("/v1/embedded-systems", {"mesh": meshes["hills"], "points": points, "springs": springs,
                                         "max_iterations": 100_000, "accuracy": {"tolerance": 1e-15}, **more})


@costly
def network_on_a_large_shell(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    springs = [{"between": [i, i + 1], "rest_length": 0.1} for i in range(20)]
    return post("/v1/embedded-systems", {"mesh": meshes["bumpy"], "points": random_points(21, BUMPY), "springs": springs,
                                         "host": {"kind": "shell", "youngs_modulus": 10, "thickness": 0.05}, "max_iterations": 100_000, **more})


@costly
def network_on_a_large_solid(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    springs = [{"between": [i, i + 1], "rest_length": 0.1} for i in range(20)]
    return post("/v1/embedded-systems", {"mesh": meshes["bumpy"], "points": random_points(21, BUMPY), "springs": springs,
                                         "host": {"kind": "solid", "youngs_modulus": 1, "element_size": 0.03}, "max_iterations": 100_000, **more})


# --- Voronoi diagrams ----------------------------------------------------------------------------------------------------

@costly
def diagram_of_many_sites(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/voronoi-diagrams", {"mesh": meshes["hills"], "sites": random_points(50_000, HILLS), "points": True,
                                         "pieces": True, **more})


@costly
def diagram_of_few_sites(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/voronoi-diagrams", {"mesh": meshes["hills"], "sites": random_points(5, HILLS),
                                         "accuracy": {"method": "bounded", "relative_error": 1e-9, "border_deviation": 1e-7}, **more})


@costly
def optimization_of_many_sites(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/voronoi-optimizations", {
        "mesh": meshes["bumpy"], "sites": random_points(5_000, BUMPY), "max_iterations": 10_000, "accuracy": {"tolerance": 1e-12},
        "objectives": {"edge_length": 1, "planarity": 1, "regularity": 1, "centroidal": 1, "equal_area": 1}, **more})


# --- many in one place -------------------------------------------------------------------------------------------------------

def in_one_face(count: int, apart: float) -> List[Any]:
    return [{"face": 0, "barycentric": [0.2 + apart * i, 0.3, 0.5 - apart * i]} for i in range(count)]


@costly
def diagram_of_many_sites_at_a_vertex(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/voronoi-diagrams", {"mesh": meshes["tetrahedron"], "sites": [{"vertex": 0}] * 100_000, **more})


@costly
def diagram_of_many_sites_in_a_face(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/voronoi-diagrams", {"mesh": meshes["tetrahedron"], "sites": in_one_face(100_000, 1e-11), **more})


@costly
def diagram_of_many_random_sites_of_four_faces(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/voronoi-diagrams", {"mesh": meshes["tetrahedron"], "sites": {"count": 100_000, "seed": 1}, **more})


@costly
def field_of_many_sources_in_a_face(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/geodesic-fields", {"mesh": meshes["tetrahedron"], "sources": in_one_face(100_000, 1e-11), **more})


@costly
def network_of_many_points_in_a_face(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/embedded-systems", {"mesh": meshes["tetrahedron"], "points": in_one_face(100_000, 1e-11),
                                         "springs": {"kind": "voronoi_dual"}, **more})


@costly
def network_of_paths_around_and_around(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/embedded-systems", {"mesh": meshes["tetrahedron"], "points": {"kind": "poisson_disk", "radius": 2.5e6},
                                         "springs": {"kind": "voronoi_dual"}, **more})


@costly
def network_on_a_shell_of_many_parts(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    points = [{"face": i, "barycentric": [0.2, 0.3, 0.5]} for i in range(2)]
    return post("/v1/embedded-systems", {"mesh": meshes["loose"], "points": points, "springs": [],
                                         "host": {"kind": "shell", "youngs_modulus": 10, "thickness": 0.05}, **more})


@costly
def diagram_on_a_needle(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    sites = [{"face": face, "barycentric": [0.3, 0.3, 0.4]} for face in range(4)]
    return post("/v1/voronoi-diagrams", {"mesh": meshes["needle"], "sites": sites,
                                         "accuracy": {"method": "bounded", "relative_error": 1e-9}, **more})


@costly
def optimization_of_a_coarse_mesh(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/voronoi-optimizations", {"mesh": meshes["cushion"], "sites": {"count": 12, "seed": 3},
                                              "objectives": {"centroidal": 1}, **more})


# --- structures ----------------------------------------------------------------------------------------------------------

@costly
def picture_of_many_cells(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return Costly("GET", "/v1/families/IH21/structure?cells=100,100&format=svg", b"")


@costly
def drawing_of_many_cells(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/structures", {"family": "IH21", "cells": [100, 100], **more}, "image/vnd.dxf")


@costly
def solid_of_many_cells(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/structures", {"family": "IH21", "cells": [100, 100], **more}, "model/stl")


@costly
def mesh_of_a_cell_as_fine_as_may_be(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/structures", {"family": "IH21", "mesh": {"mesh_size": 0.1, "corner_size": 0.5, "mesh_region": "cell"}, **more})


@costly
def simulation_of_a_fine_cell(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/simulations", {
        "family": "IH21", "load": {"uniaxial": {"direction": 0.3, "stretches": [1 - 0.001 * i for i in range(1, 400)]}},
        "accuracy": {"mesh_size": 0.1, "corner_size": 0.5, "tolerance": 1e-12, "max_iterations": 10_000, "max_load_step": 1e-5},
        **more})


@costly
def simulation_of_a_patch(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/simulations", {
        "family": "IH01", "load": {"uniaxial": {"direction": 0.3, "stretches": [1 - 0.002 * i for i in range(1, 200)]}},
        "effects": {"contact": "on", "patch": "on", "buckling": "on"}, "deformed": "json", **more})


@costly
def part_of_many_cells_under_plates(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/part-simulations", {
        "part": {"outline": {"block": {"width": 30, "height": 30}}, "structure": {"family": "IH21"}}, "states": 1000, "strain": -0.5,
        "accuracy": {"mesh_size": 0.7, "tolerance": 1e-12, "max_iterations": 10_000, "max_load_step": 1e-5},
        "effects": {"contact": "on", "buckling": "on", "error_estimate": "on"}, **more})


@costly
def pictures_of_a_part_in_many_states(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/part-simulations", {
        "part": {"outline": {"coupon": {"width": 6, "length": 6, "grip_length": 1}}, "structure": {"family": "IH01"}, "frame": 6},
        "states": 1000, "strain": 1, "deformed": "vtu", "svg": True, "accuracy": {"mesh_size": 2}, **more})


@costly
def family_of_many_placements(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    corners = [[round(math.cos(0.5 * k), 6), round(math.sin(0.5 * k), 6)] for k in range(12)]
    waves = {"class": "J", "sines": [[0.02 / (k + 1), *[0.001] * 8] for k in range(8)], "pieces": 20}
    return post("/v1/families", {"definition": {
        "id": "costly", "description": "", "beam_width": 0.01,
        "parameters": [{"description": "", "lower": 0, "upper": 1, "default": 0.5} for _ in range(8)],
        "tile": {"vertices": corners, "edges": [{"shape": k} for k in range(12)], "translations": [[3, 0], [0, 3]],
                 "placements": [{"linear": [1, 0, 0, 1], "offset": [0.1 * k, 0.1 * k]} for k in range(24)]},
        "shapes": [waves] * 12}, **more})


@costly
def family_of_a_drawing_with_many_corners(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    corners = [f"{(100 + 2 * (k % 2)) * math.cos(2 * math.pi * k / 17):.3f},{(100 + 2 * (k % 2)) * math.sin(2 * math.pi * k / 17):.3f}"
               for k in range(17)]
    svg = f'<svg xmlns="http://www.w3.org/2000/svg"><polygon points="{" ".join(corners)}"/></svg>'
    return post("/v1/families", {"svg": svg, "type": "IH01", "id": "costly", **more})


# --- models and designs --------------------------------------------------------------------------------------------------

@costly
def evaluation_of_many_strains(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    count = 100_000
    return post("/v1/models/ih29/evaluations", {"parameters": [[0.5]], "green_strain": [[0.01, 0.02, 0.001 * (i % 9)] for i in range(count)],
                                               "derivatives": 2, **more})


@costly
def uniaxial_load_of_many_states(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/models/ih29/uniaxial", {"parameters": [0.5], "direction": 0.3, "stretches": [1 + 0.0002 * i for i in range(1000)],
                                             "accuracy": {"tolerance": 1e-14, "max_iterations": 10_000}, **more})


def target() -> Dict[str, Any]:
    return {"control_points": [[0.02 * i, 0.05 * i * i] for i in range(12)]}


@costly
def design_of_any_family(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/designs", {"task": "stress_strain", "target": target(), "samples": 500, "verify": True,
                                "accuracy": {"tolerance": 1e-12, "max_iterations": 1000, "starts": 64, "candidates": 4096,
                                             "verified_samples": 200, "equilibrium_tolerance": 1e-14},
                                "effects": {"multi_start": "on", "polish": "on", "envelope": "on"}, **more})


@costly
def profile_of_many_samples(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/profiles", {"task": "stiffness", "family": "IH29", "parameters": [0.5],
                                 "x": [0.003 * i for i in range(1000)], "accuracy": {"equilibrium_tolerance": 1e-14}, **more})


@costly
def profile_far_beyond_the_model(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/profiles", {"task": "stress_strain", "family": "IH29", "parameters": [500.0], "x": [0.003 * i for i in range(1000)],
                                 "accuracy": {"equilibrium_tolerance": 1e-14}, **more})


# --- weaves --------------------------------------------------------------------------------------------------------------

def comb(teeth: int, upright: bool) -> List[List[float]]:
    points = [[float(i), float(teeth if i % 2 else 0)] for i in range(teeth)]
    return [[y, x] for x, y in points] if upright else points


@costly
def layout_of_two_combs(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/weave-layouts", {"weave": {"strands": [{"points": comb(1500, False)}, {"points": comb(1500, True)}]}, **more})


@costly
def layout_of_two_large_combs(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/weave-layouts", {"weave": {"strands": [{"points": comb(50_000, False)}, {"points": comb(50_000, True)}]}, **more})


@costly
def layout_of_cusps(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    points = [[float(i % 2), 1e-6 * i] for i in range(970)]
    return post("/v1/weave-layouts", {"weave": {"strands": [{"points": points}]}, "svg": True, **more})


@costly
def layout_of_parallel_diagonals(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    strands = [{"points": [[0.01 * i, 0.0], [1000 + 0.01 * i, 1000.0]]} for i in range(20_000)]
    return post("/v1/weave-layouts", {"weave": {"strands": strands}, **more})


@costly
def layout_of_long_strands_in_a_small_cell(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    strands = [{"points": [[0.01 * i, 0.0], [4000.0, 0.02 * i], [8000.0, 1000.0]]} for i in range(3_000)]
    return post("/v1/weave-layouts", {"weave": {"strands": strands, "lattice": [[3000, 0], [0, 3000]]}, **more})


@costly
def layout_of_listed_crossings(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    count = 600
    strands = [{"points": [[0.0, float(i)], [float(count), float(i)]]} for i in range(count)]
    strands += [{"points": [[float(i), 0.0], [float(i), float(count)]]} for i in range(count)]
    crossings = [{"members": [{"strand": i, "coordinate": k}, {"strand": count + k, "coordinate": i}]}
                 for i in range(count) for k in range(count)]
    return post("/v1/weave-layouts", {"weave": {"strands": strands, "crossings": crossings}, "svg": True, **more})


@costly
def layout_of_many_circles(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/weave-layouts", {"weave": {"pattern": "interlacing_circles", "type": 2, "sheet": {"columns": 141, "rows": 141}},
                                      "svg": True, **more})


@costly
def picture_of_huge_circles(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/weave-layouts", {"weave": {"pattern": "interlacing_circles", "type": 2, "circle_radius": 390_000, "distance": 700_000}, **more},
                "image/svg+xml")


@costly
def stiffness_of_a_fine_cell(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/weave-homogenizations", {"weave": {"pattern": "interlacing_circles", "type": 2}, "directions": 10_000, "strain": 0.2,
                                              "accuracy": {"segments": 64, "tolerance": 1e-12, "max_iterations": 10_000, "load_steps": 10_000}, **more})


@costly
def many_gradients_of_a_fine_cell(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    gradients = [[[1.2, k / 10_000], [0.1, 1]] for k in range(10_000)]
    return post("/v1/weave-deformations", {"weave": {"pattern": "interlacing_circles", "type": 2}, "deformation_gradients": gradients,
                                           "accuracy": {"segments": 64, "tolerance": 1e-12, "max_iterations": 10_000, "load_steps": 10_000}, **more})


@costly
def sheet_of_many_strands(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    sheet = {"pattern": "regular", "sheet": {"columns": 141, "rows": 141}, "pitch": 1}
    return post("/v1/weave-simulations", {"weave": sheet, "states": 1000, "deformed": "none", "accuracy": {"segments": 16}, "supports": [
        {"at": {"box": [[-1, -1], [0.7, 142]]}}, {"at": {"box": [[140.7, -1], [142, 142]]}, "displacement": [20, 0, 5]}], **more})


@costly
def sheet_of_circles(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    sheet = {"pattern": "interlacing_circles", "type": 2, "sheet": {"columns": 60, "rows": 60}}
    return post("/v1/weave-simulations", {"weave": sheet, "states": 10, "deformed": "none", "accuracy": {"segments": 64}, "supports": [
        {"at": {"box": [[-20, -20], [0, 900]]}}, {"at": {"box": [[845, -20], [900, 900]]}, "displacement": [20, 0, 0]}], **more})


@costly
def sheet_held_in_many_boxes(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    sheet = {"pattern": "regular", "sheet": {"columns": 141, "rows": 141}, "pitch": 1}
    support = {"at": {"box": [[-1, -1], [142, 6]]}}
    return post("/v1/weave-simulations", {"weave": sheet, "deformed": "none", "supports": [support] * 990, **more})


@costly
def toolpath_of_a_large_sheet(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    sheet = {"pattern": "regular", "connections": "slides_x", "pitch": 4, "radius": 0.25, "sheet": {"columns": 110, "rows": 110}}
    return post("/v1/weave-toolpaths", {"weave": sheet, "printer": {"bed": [1000, 1000, 1000]}, "chord_error": 0.01,
                                        "include": ["gcode", "svg", "moves"], **more})


@costly
def report_on_long_gcode(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    lines = ["G21", "G90", "M82", "M104 S210", "M109 S210", "G28", "G92 E0"]
    lines += [f"G1 X{i % 200} Y{(i * 7) % 200} Z0.5 E{0.05 * i:.3f} F1200" for i in range(199_000)]
    return post("/v1/gcode-reports", {"gcode": "\n".join(lines) + "\n", **more})


@costly
def report_on_one_line_of_gcode(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return post("/v1/gcode-reports", {"gcode": "X" * 30_000_000, **more})


# --- bodies --------------------------------------------------------------------------------------------------------------

@costly
def body_of_many_numbers(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    text = b'{"mesh":"' + b"0" * 64 + b'","points":[' + b"0," * 7_000_000 + b"0]}"
    return Costly("POST", "/v1/karcher-means", text)


@costly
def body_of_many_empty_texts(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    return Costly("POST", "/v1/karcher-means", b'{"mesh":"' + b"0" * 64 + b'","points":[' + b'"",' * 7_900_000 + b'""]}')


@costly
def body_of_many_faulty_fields(meshes: Meshes, more: Dict[str, Any]) -> Costly:
    point = b'{"face":-1,"barycentric":[2,3],"what":1},'
    return Costly("POST", "/v1/geodesic-fields", b'{"mesh":"' + b"0" * 64 + b'","sources":[' + point * 99_999 + point[:-1] + b"]}")


def named(name: str, meshes: Meshes, deadline: Optional[float]) -> Costly:
    return CASES[name](meshes, {} if deadline is None else {"deadline": deadline})
