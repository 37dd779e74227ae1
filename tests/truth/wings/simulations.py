"""Tilings under load, compared with the suite's own finite elements on the triangles in the server's answer, and invariances."""

from __future__ import annotations

from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np

from _elements import Cell, Law, broken_periods, respond, second_stress, tangent_of, unstable_modes
from _tilings import FAMILIES, draws, structure_of, turned
from truth import Check, Server

ABOUT = ("Random tilings under random loads. Energy, stress, tangent, equilibrium and stability of each state are computed again by finite elements "
         "of the suite's own, at the nodes that the server answers on the triangles that it answers. The other cases are invariances: units, "
         "another way to the same strain, mirrors of the tiling, stress as the energy's derivative; and in ten designs at a time, how often a finer mesh differs by more "
         "than the error that is said.")

GROUP = 10
"""Number of designs in a case that counts how often the error of the mesh exceeds its estimate."""

PATIENCE = 3600
"""Deadline of a simulation in seconds. It is long because the machine may be busy."""

CHECKS = {
    "energy": Check("energy density of the state that is answered, beside own elements", 1e-9, "of it"),
    "stress": Check("stress of the state that is answered, beside own elements", 1e-9, "of it"),
    "tangent": Check("tangent stiffness, beside own elements", 1e-6, "of it"),
    "equilibrium": Check("energy that one more step of Newton's method takes off", 1e-9, "of it"),
    "equilibrium stress": Check("stress beside that after one more step", 1e-5, "of it"),
    "stability": Check("`stable`, beside the signs of own stiffness's pivots, of all modes of 2 x 2 cells", 0, "1 if it is wrong"),
    "smallest jacobian": Check("`smallest_jacobian` above the least at a corner of a triangle", 1e-9, "plain difference"),
    "periods": Check("nodes on opposite sides, and the lattice that is answered, beside F", 1e-9, "of the cell"),
    "load": Check("strain that was imposed, and stress on free sides", 1e-7, "of the strain, or of the stress"),
    "youngs modulus": Check("stress and energy over Young's modulus, for a factor of .001 to 1000", 1e-6, "of it"),
    "half a turn": Check("stress and energy along the opposite direction", 1e-6, "of it"),
    "same strain": Check("stress and energy of one strain that is imposed in two ways, on the path's first branch", 1e-6, "of it"),
    "derivative": Check("energy between neighbouring strains, beside the integral of the stresses", 1, "of the mesh's error that is said"),
    "second derivative": Check("stress between neighbouring strains, beside the integral of the tangents", 1, "of the mesh's error that is said"),
    "mirrored tiling": Check("stress and energy of a strain that a symmetry of the tiling maps to another", 1, "of the mesh's errors that are said"),
    "mesh error": Check("designs of ten whose stress differs from that of a finer mesh by more than is said; chance exceeds the limit once in 600 times", 0.4, "share"),
}

KINDS = (("elements", 0.66), ("invariance", 0.2), ("derivative", 0.07), ("mirror", 0.058), ("mesh error", 0.012))


def case(rng: np.random.Generator) -> Dict[str, Any]:
    kind = str(rng.choice([name for name, _ in KINDS], p=[share for _, share in KINDS]))
    count = GROUP if kind == "mesh error" else 1
    return {"kind": kind, "designs": [_design(rng) for _ in range(count)], "buckling": "off" if rng.uniform() < 0.15 else "automatic",
            "contact": "automatic" if rng.uniform() < 0.3 else "off", "patch": "automatic" if rng.uniform() < 0.8 else "off",
            "law": str(rng.choice(["neo_hookean", "incompressible_plane_stress"])), "nu": float(rng.uniform(0.1, 0.49)),
            "modulus": float(10 ** rng.uniform(0, 4)), "factor": float(10 ** rng.uniform(-3, 3)), "mesh_size": float(rng.uniform(0.5, 1.5)),
            "corner_size": float(rng.uniform(0.2, 1)), "invariance": str(rng.choice(["modulus", "half a turn", "same strain"])),
            "step": [float(part) for part in rng.normal(size=3)]}


def _design(rng: np.random.Generator) -> Dict[str, Any]:
    return {"family": str(rng.choice(FAMILIES)), "shares": draws(rng), "load": str(rng.choice(["green_strain", "uniaxial", "material", "biaxial"])),
            "direction": float(rng.uniform(-np.pi, np.pi)), "stretches": [float(1 + part) for part in rng.uniform(-0.12, 0.25, size=2)]}


def _load(design: Dict[str, Any], states: int = 2) -> Dict[str, Any]:
    first, second = (1 + np.outer(np.arange(1, states + 1) / states, np.array(design["stretches"]) - 1)).T
    if design["load"] in ("uniaxial", "material"):
        return {"uniaxial": {"direction": design["direction"], "frame": "material" if design["load"] == "material" else "space", "stretches": first.tolist()}}
    if design["load"] == "biaxial":
        return {"biaxial": {"direction": design["direction"], "stretches": np.stack([first, second], axis=1).tolist()}}
    return {"green_strain": [_strain(design["direction"], pair).tolist() for pair in zip(first, second)]}


def _strain(direction: float, stretches: Any) -> Any:
    turn = turned(direction)
    return _parts(turn @ np.diag((np.array(stretches) ** 2 - 1) / 2) @ turn.T)


def _parts(tensor: Any) -> Any:
    return np.array([tensor[0, 0], tensor[1, 1], tensor[0, 1]])


def _tensor(parts: Any) -> Any:
    return np.array([[parts[0], parts[2]], [parts[2], parts[1]]])


def _norm(parts: Any) -> float:
    """The Frobenius norm of a symmetric tensor with these components."""
    return float(np.linalg.norm(_tensor(parts)))


def _apart(one: Any, other: Any) -> float:
    return _norm(np.array(one) - np.array(other)) / _norm(other)


def examine(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    if drawn["kind"] == "mesh error":
        yield from _mesh_error(server, drawn)
        return
    design = drawn["designs"][0]
    structure = structure_of(server, design["family"], design["shares"])
    if structure is None:
        return
    body = {"family": design["family"], "parameters": structure["parameters"], "load": _load(design)}
    if drawn["kind"] == "elements":
        yield from _elements(server, drawn, body)
    elif drawn["kind"] == "invariance":
        yield from _invariance(server, drawn, body)
    elif drawn["kind"] == "derivative":
        yield from _derivative(server, drawn, body)
    else:
        yield from _mirror(server, drawn, body, structure)


def _elements(server: Server, drawn: Dict[str, Any], body: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    law = Law(drawn["law"], drawn["modulus"], drawn["nu"])
    answer = server.post("/v1/simulations", {
        **body, "deadline": PATIENCE, "material": {"law": law.name, "youngs_modulus": law.youngs_modulus, "poisson_ratio": law.poisson_ratio}, "deformed": "json",
        "accuracy": {"mesh_size": drawn["mesh_size"], "corner_size": drawn["corner_size"]},
        "effects": {"refinement": "off", "contact": drawn["contact"], "patch": drawn["patch"], "buckling": drawn["buckling"]}})
    cells = [Cell(mesh) for mesh in answer["meshes"]]
    for state in answer["states"]:
        if state["stopped"] != "converged":
            continue
        cell, f = cells[state["deformed"]["mesh"]], np.array(state["deformation_gradient"])
        yield "periods", broken_periods(cell, np.array(state["deformed"]["points"]), f)
        yield "periods", np.max(np.abs(np.array(state["deformed"]["lattice"]) - cell.lattice @ f.T)) / np.sqrt(cell.area)
        yield "load", _load_deviation(drawn["designs"][0], body["load"], answer["states"].index(state), state)
        if state["contacts"] == 0:  # Energies of contact are not defined in the documents.
            yield from _state(cell, law, drawn, state)


def _state(cell: Cell, law: Law, drawn: Dict[str, Any], state: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    f = np.array(state["deformation_gradient"])
    own = respond(cell, law, np.array(state["deformed"]["points"]))
    yield "energy", own.energy / state["energy_density"] - 1
    yield "stress", _apart(state["stress"], second_stress(f, own.nominal))
    yield "equilibrium", own.decrement / own.energy
    yield "equilibrium stress", _apart(state["stress"], second_stress(f, own.corrected))
    yield "smallest jacobian", max(0.0, state["smallest_jacobian"] - own.smallest_jacobian)
    if state["tangent"] is not None:
        tangent = tangent_of(f, own.nominal, own.modulus)
        yield "tangent", np.linalg.norm(np.array(state["tangent"]) - tangent) / np.linalg.norm(tangent)
    if drawn["designs"][0]["load"] in ("green_strain", "biaxial"):  # These loads prescribe all of F.
        modes = unstable_modes(cell, own, alternating=drawn["patch"] == "automatic" and state["cells"] == 1)
        yield "stability", float(state["stable"] != (modes == 0))


def _load_deviation(design: Dict[str, Any], load: Dict[str, Any], index: int, state: Dict[str, Any]) -> float:
    f, strain, stress = np.array(state["deformation_gradient"]), np.array(state["green_strain"]), _tensor(state["stress"])
    of_f = float(np.max(np.abs(_parts((f.T @ f - np.eye(2)) / 2) - strain)))
    along = turned(design["direction"])[:, 0]
    across = turned(design["direction"])[:, 1]
    if "green_strain" in load:
        return max(of_f, float(np.max(np.abs(strain - np.array(load["green_strain"][index])))))
    if "biaxial" in load:
        return max(of_f, float(np.max(np.abs(strain - _strain(design["direction"], load["biaxial"]["stretches"][index])))))
    stretch = load["uniaxial"]["stretches"][index]
    material = load["uniaxial"]["frame"] == "material"
    imposed = float(np.max(np.abs((f @ along if material else f.T @ along) - stretch * along)))
    free = across if material else f.T @ across
    return max(of_f, imposed, float(np.linalg.norm(stress @ free)) / float(np.linalg.norm(stress)))


def _plain(server: Server, body: Dict[str, Any], **more: Any) -> List[Dict[str, Any]]:
    """States on a coarse mesh, with the tolerance that is needed to compare two answers."""
    answer = server.post("/v1/simulations", {**body, "deadline": PATIENCE, "accuracy": {"mesh_size": 1, "corner_size": 0.5, "tolerance": 1e-10}, "tangents": False,
                                             "effects": {"refinement": "off", "contact": "off"}, **more})
    return [state for state in answer["states"] if state["stopped"] == "converged"]


def _invariance(server: Server, drawn: Dict[str, Any], body: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    base = _plain(server, body)
    scale, name, load, more = 1.0, drawn["invariance"], body["load"], {}
    if name == "modulus":
        name, scale, more = "youngs modulus", drawn["factor"], {"material": {"youngs_modulus": 26 * drawn["factor"]}}
    elif name == "half a turn" and "green_strain" not in load:
        key = "uniaxial" if "uniaxial" in load else "biaxial"
        load = {key: {**load[key], "direction": load[key]["direction"] + np.pi}}
    else:
        name, load = "same strain", {"green_strain": [state["green_strain"] for state in base]}
    if not base:
        return
    other = _plain(server, {**body, "load": load}, **more)
    for one, two in zip(base, other):
        if name == "same strain" and (one["branch"] or two["branch"] or one["cells"] != two["cells"]):
            return  # After a bifurcation, different paths to the same strain need not reach the same state.
        yield name, max(_apart(np.array(two["stress"]) / scale, one["stress"]), abs(two["energy_density"] / scale / one["energy_density"] - 1))


def _default(server: Server, body: Dict[str, Any]) -> Dict[str, Any]:
    answer = server.post("/v1/simulations", {**body, "deadline": PATIENCE, "effects": {"contact": "off"}})
    assert isinstance(answer, dict)
    return answer


def _judged(states: List[Dict[str, Any]]) -> bool:
    return all(state["stopped"] == "converged" and state["stress_error"] is not None for state in states)


def _derivative(server: Server, drawn: Dict[str, Any], body: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    """Compares the difference of the energies at two strains with the integral of the stress by Hermite's rule, whose error is of fifth order in the step."""
    design = drawn["designs"][0]
    strain = _strain(design["direction"], design["stretches"])
    step = 2e-3 * np.array(drawn["step"]) / _norm(drawn["step"])
    states = _default(server, {**body, "load": {"green_strain": [(strain + share * step).tolist() for share in (0, 1, 2)]}})["states"]
    if len(states) < 3 or not _judged(states) or len({(state["branch"], state["cells"]) for state in states}) > 1:
        return
    engineering = step * np.array([1, 1, 2])
    for one, two in zip(states, states[1:]):
        tangents = [np.array(state["tangent"]) for state in (one, two)]
        stresses = np.array(one["stress"]) + np.array(two["stress"])
        rise = stresses @ engineering / 2 + engineering @ (tangents[0] - tangents[1]) @ engineering / 12
        error = max(one["stress_error"], two["stress_error"])
        yield "derivative", (two["energy_density"] - one["energy_density"] - rise) / (error * _norm(step))
        yield "second derivative", _norm(np.array(two["stress"]) - one["stress"] - (tangents[0] + tangents[1]) @ engineering / 2) / error


def _symmetry(structure: Dict[str, Any], design: Dict[str, Any]) -> Optional[Any]:
    """A reflection, or a rotation by less than half a turn, that maps the tiling to itself, since it maps the corners of holes to such corners."""
    lattice = np.array(structure["lattice"])
    inverse = np.linalg.inv(lattice)
    holes = [np.array(hole) for tile in structure["tiles"] for hole in tile["holes"]]
    if not holes:
        return None
    corners = np.concatenate(holes + [(hole + np.roll(hole, -1, axis=0)) / 2 for hole in holes])
    axes = [np.array([i, j]) @ lattice for i in (-2, -1, 0, 1, 2) for j in (-2, -1, 0, 1, 2) if (i, j) > (0, 0)]
    angles = sorted({round(float(np.mod(2 * np.arctan2(axis[1], axis[0]), 2 * np.pi)), 9) for axis in axes})
    maps = [np.array([[np.cos(a), np.sin(a)], [np.sin(a), -np.cos(a)]]) for a in angles]
    maps += [turned(angle) for angle in (np.pi / 2, np.pi / 3, 2 * np.pi / 3)]
    start = int(1000 * abs(design["direction"])) % len(maps)
    for image in maps[start:] + maps[:start]:
        repeated = lattice @ image.T @ inverse
        if np.max(np.abs(repeated - np.rint(repeated))) > 1e-6:
            continue
        moved = corners @ image.T
        for place in corners:
            shares = np.mod((moved + place - moved[0]) @ inverse, 1.0)
            apart = shares[:, None] - np.mod(corners @ inverse, 1.0)[None]
            if np.max(np.min(np.max(np.abs(apart - np.rint(apart)), axis=2), axis=1)) < 1e-6:
                return image
    return None


def _mirror(server: Server, drawn: Dict[str, Any], body: Dict[str, Any], structure: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    design = drawn["designs"][0]
    image = _symmetry(structure, design)
    if image is None:
        return
    strain = _strain(design["direction"], 1 + (np.array(design["stretches"]) - 1) / 4)
    answers = [_default(server, {**body, "load": {"green_strain": [_parts(q @ _tensor(strain) @ q.T).tolist()]}}) for q in (np.eye(2), image)]
    states = [answer["states"][-1] for answer in answers]
    if not _judged(states):
        return
    back = _parts(image.T @ _tensor(states[1]["stress"]) @ image)
    errors = sum(state["stress_error"] for state in states), sum(state["energy_density_error"] for state in states)
    yield "mirrored tiling", max(_norm(back - np.array(states[0]["stress"])) / errors[0],
                                 abs(states[1]["energy_density"] - states[0]["energy_density"]) / errors[1])


def _mesh_error(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    """In 90 of 100 simulations the estimated error is larger than the difference to a finer mesh."""
    judged = beyond = 0
    for design in drawn["designs"]:
        structure = structure_of(server, design["family"], design["shares"])
        if structure is None:
            continue
        body = {"family": design["family"], "parameters": structure["parameters"], "load": _load(design, 1)}
        said = _default(server, body)
        fine = server.post("/v1/simulations", {**body, "deadline": PATIENCE, "accuracy": {"mesh_size": 0.5, "corner_size": 0.05}, "tangents": False,
                                               "effects": {"contact": "off", "refinement": "on"}})
        if not _judged(said["states"] + fine["states"]):
            continue
        judged += 1
        beyond += _apart(said["states"][0]["stress"], fine["states"][0]["stress"]) > said["accuracy"]["discretization_error"]["stress"]
    if judged:
        yield "mesh error", beyond / GROUP
