"""Networks and hosts for the tests of elastic networks on surfaces."""

from __future__ import annotations

from typing import Any, Dict, List

import numpy as np

from shapes import sphere

NETWORKS = "/v1/embedded-systems"
CENTRES = {"kind": "per_face", "barycentric": [0.3, 0.3, 0.4]}
CORNERS = [0, 8, 72, 80]
"""Corner vertices of the grid of 8 x 8 cells."""
SHELL = {"kind": "shell", "thickness": 0.01, "youngs_modulus": 1000, "poisson_ratio": 0.45, "volume_weight": 100}


def at_vertices(*vertices: int) -> List[Dict[str, int]]:
    return [{"vertex": v} for v in vertices]


def springs(*pairs: Any, **constants: float) -> List[Dict[str, Any]]:
    return [{"between": list(pair), **constants} for pair in pairs]


def effect(answer: Any, name: str) -> Any:
    (found,) = [e for e in answer["effects"] if e["name"] == name]
    return found


def volume(vertices: Any, faces: Any) -> float:
    a, b, c = (np.asarray(vertices)[np.asarray(faces)[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def net(mesh: str, **more: Any) -> Dict[str, Any]:
    """Twelve points on the sphere, each in a face at a vertex of the icosahedron, and stretched springs between neighbours."""
    vertices, faces = sphere(3)
    at = [int(np.flatnonzero((faces == v).any(axis=1))[0]) for v in range(12)]
    pairs = [(i, j) for i in range(12) for j in range(i) if vertices[i] @ vertices[j] > 0.4]
    assert len(pairs) == 30
    return {"mesh": mesh, "points": [{"face": face, "barycentric": [0.4, 0.35, 0.25]} for face in at],
            "springs": springs(*pairs, rest_length=0.6, weight=0.5), "fixed_points": [0, 3], **more}
