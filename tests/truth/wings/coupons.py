"""Coupons between grips: the exported part, meshed and pulled by finite elements of the suite's own, beside the response of the design."""

from __future__ import annotations

from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np
from shapely.geometry import box

import _solids
from _coupons import Coupon, Linear, NoEquilibrium
from _elements import Law
from _tilings import FAMILIES, draws, structure_of, turned
from truth import Check, Refusal, Server

ABOUT = ("Random tilings are laid along a random direction of their design into coupons of a few cells. The DXF file is meshed and pulled between its grips by the suite's own elements, in "
         "plane strain and with the law that the documents name, and its force compared with that of a homogeneous sheet between the same grips, which has the stiffness of the periodic design, turned as "
         "the documents say. What remains are the cells cut at the sides, which count less the more cells there are; a coupon that is laid otherwise is off by factors.")

BEAM = 0.3
"""Width of the beams in mm."""
GRIP = 0.6
"""Length of a grip in mm. Nodes of the grips do not move in them."""
LAW = Law("neo_hookean", 26.0, 0.48)
"""The law of the server's default material, in plane strain."""
AT_REST = 1e-4
"""The strain at which the tangent of the design is asked for."""
STRAINS = [0.01, 0.02]
"""Nominal strains of the curves, without contact."""
PATIENCE = 3600
"""Deadline of a simulation in seconds. It is long because the machine may be busy."""
SIDES = 6
"""Elements along the width of the homogeneous sheet."""
FACTOR = float(np.log(2.5))
"""What cut cells may do to a coupon that is four cells wide. A part that is not turned is off by more in most directions of most families."""
MAX_GRIP_EFFECT = 0.1
"""Curves are compared where grips change the force of the sheet by less."""

CHECKS = {
    "force of 8 cells": Check("force of a coupon 8 cells long and 4 wide, beside that of a homogeneous sheet between its grips", FACTOR, "logarithm of the ratio", 0.05),
    "force of 16 cells": Check("the same, of 16 cells and 8", FACTOR / 2, "logarithm of the ratio", 0.1),
    "convergence": Check("cases of which 16 cells are farther from the sheet than 4 cells and than 5 %", 0, "1 if they are", 0.2),
    "curve": Check("force over strain at 2 %, over that at rest, beside the design's curve, of coupons whose grips change little", 0.1, "of it", 0.1),
}


def case(rng: np.random.Generator) -> Dict[str, Any]:
    return {"kind": str(rng.choice(["force", "convergence", "curve"], p=[0.9, 0.05, 0.05])), "family": str(rng.choice(FAMILIES)), "shares": draws(rng),
            "direction": float(rng.uniform(-np.pi / 2, np.pi / 2))}


def examine(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    structure = structure_of(server, drawn["family"], drawn["shares"], BEAM)
    if structure is None:
        return
    design = {"family": drawn["family"], "parameters": structure["parameters"]}
    tangent, moduli = _design(server, design, drawn["direction"])
    size = float(np.sqrt(abs(np.linalg.det(np.array(structure["lattice"])))))
    counts = {"force": [8], "convergence": [4, 16], "curve": [8]}[drawn["kind"]]
    coupons = [coupon for cells in counts if (coupon := _coupon(server, design, drawn["direction"], cells, size)) is not None]
    if len(coupons) < len(counts):
        return
    if drawn["kind"] == "force":
        yield "force of 8 cells", _apart(coupons[0], tangent)
    elif drawn["kind"] == "convergence":
        few, many = (_apart(coupon, tangent) for coupon in coupons)
        yield "force of 16 cells", many
        yield "convergence", float(abs(many) > max(abs(few), np.log(1.05)))
    elif len(moduli) == 2 and abs(_sheet(coupons[0]).stretched(Linear(tangent)).force / moduli[0] - 1) <= MAX_GRIP_EFFECT:
        try:
            state = coupons[0].pulled(LAW, STRAINS)[-1]
        except NoEquilibrium:  # Slender beams buckle where cells are cut.
            return
        rest = coupons[0].stretched(LAW)
        yield "curve", (state.force / state.strain) / (rest.force / rest.strain) / (moduli[1] / moduli[0]) - 1


def _design(server: Server, design: Dict[str, Any], direction: float) -> Tuple[Any, List[float]]:
    """The tangent of the periodic design at rest, turned so that its direction lies along y, and its nominal stress over nominal strain at rest
    and at the last of STRAINS, if the simulation gets there."""
    load = {"uniaxial": {"direction": direction, "frame": "material", "stretches": [1 + AT_REST, 1 + STRAINS[-1]]}}
    states = server.post("/v1/simulations", {**design, "load": load, "deadline": PATIENCE, "accuracy": {"mesh_size": 1, "corner_size": 0.5},
                                             "effects": {"refinement": "off", "contact": "off", "buckling": "off"}})["states"]
    along = np.array([np.cos(direction), np.sin(direction)])
    moduli = []
    for state, strain in zip(states, (AT_REST, STRAINS[-1])):
        if state["stopped"] != "converged":
            break
        stress = np.array([[state["stress"][0], state["stress"][2]], [state["stress"][2], state["stress"][1]]])
        moduli.append(float((1 + strain) * along @ stress @ along / strain))
    return _turned(np.array(states[0]["tangent"]), np.pi / 2 - direction), moduli


def _turned(tangent: Any, angle: float) -> Any:
    """The tangent of a structure that is turned counterclockwise."""
    place = np.array([[0, 2], [2, 1]])
    q = turned(angle)
    full = np.einsum("ai,bj,ck,dl,ijkl->abcd", q, q, q, q, tangent[place][:, :, place])
    pairs = ((0, 0), (1, 1), (0, 1))
    return np.array([[full[a, b, c, d] for c, d in pairs] for a, b in pairs])


def _coupon(server: Server, design: Dict[str, Any], direction: float, cells: int, size: float) -> Optional[Coupon]:
    """A coupon of so many cells between its grips, and of half as many across. None if too few beams reach from grip to grip, so that the part has lost one."""
    body = {"outline": {"coupon": {"width": cells / 2 * size, "length": cells * size, "grip_length": GRIP}}, "structure": design, "beam_width": BEAM, "direction": direction}
    try:
        part = _solids.of_rings(_solids.dxf_rings(server.file("/v1/parts", body, "image/vnd.dxf").decode()))
    except Refusal as refusal:
        if refusal.code != "tiling.part":
            raise
        return None
    whole = part.bounds[3] - part.bounds[1] > cells * size + 1.99 * GRIP
    return Coupon(part, GRIP, BEAM) if whole else None


def _sheet(coupon: Coupon) -> Coupon:
    """A sheet without holes of the same size between grips."""
    return Coupon(box(0, 0, coupon.width, coupon.length), 0.0, coupon.width / SIDES)


def _apart(coupon: Coupon, tangent: Any) -> float:
    return float(np.log(coupon.stretched(LAW).force / _sheet(coupon).stretched(Linear(tangent)).force))
