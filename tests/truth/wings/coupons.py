"""Coupons between grips: the exported part beside a drawing of the suite's own, and meshed and pulled by its own finite elements beside the response of the design."""

from __future__ import annotations

from typing import Any, Dict, Iterator, Optional, Tuple

import numpy as np
from shapely.geometry import box
from shapely.ops import unary_union

import _solids
from _coupons import Coupon, Linear
from _drawings import beams, differing, placed
from _elements import Law
from _tilings import FAMILIES, draws, structure_of, turned
from truth import Check, Refusal, Server

ABOUT = ("Random tilings are laid along a random direction of their design into coupons of a few cells. The DXF file is laid over an own drawing, which has beams along the sides of the design's "
         "tiles, turned as the documents say. It is meshed and pulled between its grips by the suite's own elements, in plane strain and with the law that the documents name, and its force "
         "compared with that of a homogeneous sheet between the same grips, which has the stiffness of the periodic design in the same direction. Cells that are cut at the sides make a coupon softer, "
         "some tilings by much; only the grips make it stiffer.")

BEAM = 0.3
"""Width of the beams in mm."""
GRIP = 0.6
"""Length of a grip in mm. Nodes of the grips do not move in them."""
LAW = Law("neo_hookean", 26.0, 0.48)
"""The law of the server's default material, in plane strain."""
AT_REST = 1e-4
"""The strain at which the tangent of the design is asked for."""
PATIENCE = 3600
"""Deadline of a simulation in seconds. It is long because the machine may be busy."""
SIDES = 20
"""Elements along the width of the homogeneous sheet. With six, a sheet that is much stiffer along one direction than along others is too stiff by up to 40 %."""
CELLS = 6
"""Cells along a coupon. It is half as wide."""
STIFFER = float(np.log(CELLS / (CELLS - 2)))
"""What grips may do to a coupon. They hold the ends of beams that would move against each other in the design, which stiffens about a cell beside each grip; were both rigid,
the others would bear their strain too. Free sides do not stiffen: motions of the whole sheet are possible in a piece of it, and cost no more there."""
SOFTER = float(np.log(2.5))
"""What cut cells may do to most coupons. Where straight rows of beams bear the load without bending, those that end at a free side bear nothing there, and the others bend
over many cells: such coupons are softer by factors, and approach the sheet slowly as the number of cells grows."""

CHECKS = {
    "drawing": Check("area between the coupon and an own drawing of it, less what `checks` says was left out or added", 1e-5, "of the outline's area"),
    "stiffer": Check(f"by how much a coupon {CELLS} cells long and {CELLS // 2} wide is stiffer than a homogeneous sheet between its grips", STIFFER, "logarithm of the ratio"),
    "softer": Check("by how much it is softer", SOFTER, "logarithm of the ratio", 0.3),
    "convergence": Check(f"cases of which {2 * CELLS} cells are farther from the sheet than {CELLS} cells and than 5 %", 0, "1 if they are", 0.2),
}


def case(rng: np.random.Generator) -> Dict[str, Any]:
    return {"kind": str(rng.choice(["force", "convergence"], p=[0.9, 0.1])), "family": str(rng.choice(FAMILIES)), "shares": draws(rng),
            "direction": float(rng.uniform(-np.pi / 2, np.pi / 2))}


def examine(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    structure = structure_of(server, drawn["family"], drawn["shares"], BEAM)
    if structure is None:
        return
    design = {"family": drawn["family"], "parameters": structure["parameters"]}
    tangent = _design(server, design, drawn["direction"])
    size = float(np.sqrt(abs(np.linalg.det(np.array(structure["lattice"])))))
    coupons = []
    for cells in ([CELLS, 2 * CELLS] if drawn["kind"] == "convergence" else [CELLS]):
        body = {"outline": {"coupon": {"width": cells / 2 * size, "length": cells * size, "grip_length": GRIP}}, "structure": design, "beam_width": BEAM,
                "direction": drawn["direction"]}
        part = _part(server, body)
        if part is None:
            return
        yield "drawing", differing(part, _drawn(structure, body), server.post("/v1/parts", body)["checks"], _outline(body))
        if part.bounds[3] - part.bounds[1] < cells * size + 1.99 * GRIP:  # Too few beams reach from grip to grip, and the part has lost one.
            return
        coupons.append(Coupon(part, GRIP, BEAM))
    apart = [float(np.log(coupon.stretched(LAW).force / _sheet(coupon).stretched(Linear(tangent)).force)) for coupon in coupons]
    yield "stiffer", max(apart[0], 0.0)
    yield "softer", max(-apart[0], 0.0)
    if drawn["kind"] == "convergence":
        yield "convergence", float(abs(apart[1]) > max(abs(apart[0]), np.log(1.05)))


def _design(server: Server, design: Dict[str, Any], direction: float) -> Any:
    """The tangent of the periodic design at rest, turned so that its direction lies along y."""
    load = {"uniaxial": {"direction": direction, "frame": "material", "stretches": [1 + AT_REST]}}
    answer = server.post("/v1/simulations", {**design, "load": load, "deadline": PATIENCE, "accuracy": {"mesh_size": 1, "corner_size": 0.5},
                                             "effects": {"refinement": "off", "contact": "off", "buckling": "off"}})
    return _turned(np.array(answer["states"][0]["tangent"]), np.pi / 2 - direction)


def _turned(tangent: Any, angle: float) -> Any:
    """The tangent of a structure that is turned counterclockwise."""
    place = np.array([[0, 2], [2, 1]])
    q = turned(angle)
    full = np.einsum("ai,bj,ck,dl,ijkl->abcd", q, q, q, q, tangent[place][:, :, place])
    pairs = ((0, 0), (1, 1), (0, 1))
    return np.array([[full[a, b, c, d] for c, d in pairs] for a, b in pairs])


def _part(server: Server, body: Dict[str, Any]) -> Optional[Any]:
    """The part of the DXF file. None if nothing lies between the grips."""
    try:
        return _solids.of_rings(_solids.dxf_rings(server.file("/v1/parts", body, "image/vnd.dxf").decode()))
    except Refusal as refusal:
        if refusal.code != "tiling.part":
            raise
        return None


def _outline(body: Dict[str, Any]) -> Any:
    coupon = body["outline"]["coupon"]
    return box(0, 0, coupon["width"], coupon["length"] + 2 * coupon["grip_length"])


def _drawn(structure: Dict[str, Any], body: Dict[str, Any]) -> Any:
    """The suite's own drawing of the coupon: the direction of the design lies along y."""
    outline = _outline(body)
    width, length = outline.bounds[2:]
    laid = placed(beams(structure), structure, outline, np.pi / 2 - body["direction"])
    return unary_union([laid.intersection(outline), box(0, 0, width, GRIP), box(0, length - GRIP, width, length)])


def _sheet(coupon: Coupon) -> Coupon:
    """A sheet without holes of the same size between grips."""
    return Coupon(box(0, 0, coupon.width, coupon.length), 0.0, coupon.width / SIDES)
