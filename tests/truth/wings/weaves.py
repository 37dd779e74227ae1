"""Weaves, compared with closed forms for straight strands, scalings, symmetries, other paths to the same strain, and the suite's own reader of G-code."""

from __future__ import annotations

import itertools
from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np

import _gcode
from _tilings import turned
from truth import Check, Refusal, Server

ABOUT = ("Random cells and sheets of all patterns. Straight strands have closed forms; units scale; an answer is not above what other paths, neighbouring directions or a "
         "symmetry of the pattern reach; stresses are the energy's derivatives, reactions the work's; G-code is read again by the suite's own code and laid over the strands.")

CHECKS = {
    "straight modulus": Check("modulus and Poisson's ratio of straight strands at right angles along one family, beside EA / pitch and 0", 1e-6, "of the modulus"),
    "two families": Check("energy and stress of two families at any angle, stretched along themselves and turned, beside closed forms", 1e-6, "of it"),
    "shear": Check("shear stiffness of fused straight strands of two radii, beside that of clamped beams", 1, "of the error that the contract says for 2, 4 and 8 segments"),
    "definitions": Check("modulus, Poisson's ratio, strain and Cauchy stress, computed from F and the nominal stress", 1e-9, "of the largest part"),
    "free stress": Check("stress across the direction of a load", 1e-3, "of the stress"),
    "youngs modulus": Check("stresses and energies over Young's modulus, for a factor of .01 to 1000", 1e-12, "of it"),
    "lengths": Check("moduli over the scale of all lengths, for a factor of .1 to 10", 1e-6, "of it"),
    "half a turn": Check("energy along the opposite direction", 5e-3, "of it"),
    "symmetry": Check("energy along the direction to which a symmetry of the pattern maps another", 5e-3, "of it"),
    "without buckling": Check("energy above that of the path that leaves no branch", 5e-3, "of that"),
    "neighbours": Check("energy above the mean of those in directions 1e-4 rad to either side", 5e-3, "of that"),
    "load steps": Check("energy above that of a path of four times as many steps", 5e-3, "of that"),
    "limit error": Check("`limit_error` of a state of which the message is silent", 1e-6, "of the energy"),
    "derivative": Check("energy between neighbouring F on one branch, beside the integral of the nominal stress", 1e-3, "of it"),
    "reactions": Check("sum of the reactions and forces of a sheet", 1e-6, "of the largest"),
    "work": Check("energy between states of a sheet, beside the integral of the reactions along the supports' way", 2e-2, "of it"),
    "sheet scales": Check("energy over the cube of the scale of all lengths", 1e-6, "of it"),
    "printed lengths": Check("lengths and filament in the answer, beside own reading of the G-code", 1e-3, "of it"),
    "printed volume": Check("filament beside length times cross-section of the moves", 1e-3, "of it"),
    "printed strands": Check("distance of printed strands from the strands of the layout, beyond the chord error", 1e-3, "mm"),
    "whole strands": Check("length of the strands in the plane as printed, without overruns, beside the layout", 2e-3, "of it"),
    "own check": Check("violations in G-code of the server's own", 0, "count"),
}

KINDS = (("straight", 0.12), ("families", 0.12), ("shear", 0.08), ("scales", 0.14), ("symmetry", 0.14), ("paths", 0.2), ("derivative", 0.08),
         ("sheet", 0.04), ("print", 0.08))
SHEAR_ERRORS = {2: 0.335, 4: 0.115, 8: 0.035}
"""Errors by number of segments according to the contract, 33, 11 and 3 %, rounded up."""
SHEET_STATES = 24
"""Number of states on the path of a sheet. With few states, Simpson's rule for the work of the reactions is inaccurate if the sheet stiffens late."""
TRIES = 4
"""Number of random prints in a case, of which one is used: crossings that are too close to each other cannot be printed."""


def case(rng: np.random.Generator) -> Dict[str, Any]:
    kind = str(rng.choice([name for name, _ in KINDS], p=[share for _, share in KINDS]))
    return {"kind": kind, "weaves": [_weave(rng, kind) for _ in range(TRIES if kind == "print" else 1)], "modulus": float(10 ** rng.uniform(1, 4)),
            "strain": _strain(rng), "directions": [float(angle) for angle in rng.uniform(-np.pi, np.pi, size=4)], "along": int(rng.integers(2)),
            "pitches": [float(pitch) for pitch in rng.uniform(2, 10, size=2)], "radii": [float(radius) for radius in rng.uniform(0.1, 0.5, size=2)],
            "angles": [float(rng.uniform(0, 2 * np.pi)), float(rng.uniform(0.4, 2.7)), float(rng.uniform(-0.5, 0.5))],
            "stretches": [float(stretch) for stretch in rng.uniform(1, 1.3, size=2)], "start": float(rng.uniform(0.1, 0.9)),
            "segments": int(rng.choice([2, 4, 8])), "factor": float(10 ** rng.uniform(-2, 3)), "scale": float(10 ** rng.uniform(-1, 1)),
            "other": str(rng.choice(["without buckling", "neighbours", "load steps"])), "step": [float(part) for part in rng.normal(size=4)],
            "connections": [[str(one) for one in rng.choice(["fused", "slides_x", "slides_y"], size=2)] for _ in range(2)],
            "count": int(rng.choice([1, 4, 24])), "move": [float(part) for part in rng.uniform(-0.15, 0.25, size=2)],
            "overrun": [float(part) for part in rng.uniform(0, 10, size=2)]}


def _strain(rng: np.random.Generator) -> float:
    strain = float(rng.uniform(-0.2, 0.4))
    return strain if abs(strain) > 0.02 else 0.1


def _weave(rng: np.random.Generator, kind: str) -> Dict[str, Any]:
    pattern = str(rng.choice(["regular", "interlacing_squares", "interlacing_circles"], p=[0.2, 0.55, 0.25]))
    weave: Dict[str, Any] = {"pattern": pattern, "radius": float(rng.uniform(0.15, 0.35))}
    if pattern == "regular":
        weave["connections"] = [[str(one) for one in rng.choice(["fused", "slides_x", "slides_y"], size=2)] for _ in range(2)]
        weave["pitch"] = float(rng.uniform(3, 12))
        if kind == "print":
            weave["connections"] = str(rng.choice(["fused", "slides_x", "slides_y"]))
    elif pattern == "interlacing_squares":
        weave["type"] = int(rng.integers(1, 5))
        weave["side"] = float(rng.uniform(8, 40))
        weave["overlap"] = float(weave["side"] * rng.uniform(0.12, 0.4))
    else:
        weave["type"] = int(rng.integers(1, 3))
        weave["circle_radius"] = float(rng.uniform(4, 16))
        weave["distance"] = float(weave["circle_radius"] * rng.uniform(1.5, 1.92))
    if pattern != "regular" and weave["type"] > 1:
        weave["sliding_share"] = float(rng.uniform(0.3, 0.95))
    if kind in ("sheet", "print"):
        weave["sheet"] = {"columns": int(rng.integers(2, 5)), "rows": int(rng.integers(2, 5))}
    return weave


def examine(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    yield from {"straight": _straight, "families": _families, "shear": _shear, "scales": _scales, "symmetry": _symmetries, "paths": _paths,
                "derivative": _derivative, "sheet": _sheet, "print": _print}[drawn["kind"]](server, drawn)


def _homogenize(server: Server, weave: Dict[str, Any], strain: float, directions: List[float], **more: Any) -> Dict[str, Any]:
    answer = server.post("/v1/weave-homogenizations", {"weave": weave, "strain": strain, "directions": directions, **more})
    assert isinstance(answer, dict)
    return answer


def _straight(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    pitch, radius, modulus = drawn["pitches"][0], drawn["radii"][0], drawn["modulus"]
    weave = {"pattern": "regular", "connections": drawn["connections"], "pitch": pitch, "radius": radius, "material": {"youngs_modulus": modulus}}
    answer = _homogenize(server, weave, abs(drawn["strain"]), [drawn["along"] * np.pi / 2])
    yield "straight modulus", answer["youngs_modulus"][0] / (1000 * modulus * np.pi * radius ** 2 / pitch) - 1
    yield "straight modulus", answer["poisson_ratio"][0]
    yield from _defined(answer)


def _lattice_of_two(drawn: Dict[str, Any], angles: List[float]) -> Tuple[Dict[str, Any], Any]:
    """A weave of two families of straight strands through the points of a lattice, and the unit vectors along them."""
    along = np.array([[np.cos(angle), np.sin(angle)] for angle in (angles[0], angles[0] + angles[1])])
    lattice = along * np.array(drawn["pitches"])[:, None]
    strands = [{"points": [(drawn["start"] * one).tolist()], "ends": "periodic", "translation": one.tolist(), "radius": radius}
               for one, radius in zip(lattice, drawn["radii"])]
    return {"strands": strands, "lattice": lattice.tolist(), "material": {"youngs_modulus": drawn["modulus"]}}, along


def _families(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    weave, along = _lattice_of_two(drawn, drawn["angles"])
    area = abs(np.linalg.det(weave["lattice"]))
    stretches = np.array(drawn["stretches"])
    f = turned(drawn["angles"][2]) @ (along.T * stretches) @ np.linalg.inv(along.T)
    answer = server.post("/v1/weave-deformations", {"weave": weave, "deformation_gradients": [f.tolist()]})
    stiffness = 1000 * drawn["modulus"] * np.pi * np.array(drawn["radii"]) ** 2 * np.array(drawn["pitches"]) / area
    energy = np.sum(stiffness * (stretches - 1) ** 2) / 2
    stress = sum(k * (stretch - 1) * np.outer(f @ one / stretch, one) for k, stretch, one in zip(stiffness, stretches, along))
    yield "two families", answer["energy_density"][0] / energy - 1
    yield "two families", np.linalg.norm(np.array(answer["nominal_stress"][0]) - stress) / np.linalg.norm(stress)


def _shear(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    """Compares the shear stiffness with a closed form: the strands of both families bend between joints with fixed angles, as two springs 12 EI / L in series."""
    weave, _ = _lattice_of_two(drawn, [0.0, np.pi / 2])
    segments, shear = drawn["segments"], 1e-3
    answer = server.post("/v1/weave-deformations", {"weave": weave, "deformation_gradients": [[[1, shear], [0, 1]]],
                                                    "accuracy": {"segments": segments, "tolerance": 1e-9}, "effects": {"out_of_plane": "off"}})
    springs = 12 * drawn["modulus"] * np.pi / 4 * np.array(drawn["radii"]) ** 4 / np.array(drawn["pitches"])
    stiffness = 1000 * springs[0] * springs[1] / springs.sum() / np.prod(drawn["pitches"])
    yield "shear", (2 * answer["energy_density"][0] / shear ** 2 / stiffness - 1) / SHEAR_ERRORS[segments]


def _defined(answer: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    silent = answer["message"] == ""
    for k, angle in enumerate(answer["directions"]):
        if answer["stopped"][k] != "converged":
            continue
        d, n = turned(angle).T
        f, p, strain = np.array(answer["deformation_gradient"][k]), np.array(answer["nominal_stress"][k]), answer["strain"]
        cauchy = p @ f.T / np.linalg.det(f)
        size = np.max(np.abs(cauchy)) + 1e-9
        yield "definitions", np.max(np.abs(np.array(answer["cauchy_stress"][k]) - cauchy)) / size
        yield "definitions", (answer["youngs_modulus"][k] - d @ cauchy @ d / strain) * strain / size
        yield "definitions", answer["poisson_ratio"][k] + n @ (f - np.eye(2)) @ n / strain
        yield "definitions", np.max(np.abs(f.T @ d - (1 + strain) * d))
        if abs(answer["youngs_modulus"][k]) > 1:  # Cells that slide freely have no stress except rounding.
            yield "free stress", np.linalg.norm(p.T @ n) / np.linalg.norm(p)
        if silent:
            yield "limit error", np.nan if answer["limit_error"][k] is None else answer["limit_error"][k]


def _scaled(weave: Dict[str, Any], scale: float) -> Dict[str, Any]:
    lengths = ("radius", "pitch", "side", "overlap", "circle_radius", "distance")
    return {key: value * scale if key in lengths else value for key, value in weave.items()}


def _scales(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    weave = drawn["weaves"][0]
    base = _homogenize(server, weave, drawn["strain"], drawn["directions"])
    yield from _defined(base)
    stiffer = _homogenize(server, {**weave, "material": {"youngs_modulus": 3500 * drawn["factor"]}}, drawn["strain"], drawn["directions"])
    larger = _homogenize(server, _scaled(weave, drawn["scale"]), drawn["strain"], drawn["directions"])
    for name, other, factor in (("youngs modulus", stiffer, drawn["factor"]), ("lengths", larger, drawn["scale"])):
        for k, stopped in enumerate(base["stopped"]):
            if stopped != other["stopped"][k]:
                yield name, np.nan
            elif stopped == "converged":
                stress, energy = np.array(base["nominal_stress"][k]), base["energy_density"][k]
                yield name, np.linalg.norm(np.array(other["nominal_stress"][k]) / factor - stress) / max(np.linalg.norm(stress), _bending(weave))
                yield name, (other["energy_density"][k] / factor - energy) / max(energy, 1e-3 * drawn["strain"] ** 2 * _bending(weave))
                yield name, other["poisson_ratio"][k] - base["poisson_ratio"][k]


def _bending(weave: Dict[str, Any]) -> float:
    """The stress EI / L^3 of strands of the default material, in N/m, where L is the largest length of the pattern. The residual of an equilibrium with
    the default tolerance is about a millionth of this, so that it is the scale of small stresses."""
    size = weave.get("pitch", weave.get("side", weave.get("distance", 4)))
    return float(1000 * 3500 * np.pi / 4 * weave["radius"] ** 4 / size ** 3)


def _above(weave: Dict[str, Any], strain: float, one: Dict[str, Any], other: Dict[str, Any], both_ways: bool = False) -> Iterator[float]:
    """Relative excess of the first answer's energies over those of the second, in directions in which both converged. Energies below 1e-5 of that of
    bending, which remain in cells that slide freely, are not distinguished."""
    for k, (energy, least) in enumerate(zip(one["energy_density"], other["energy_density"])):
        if one["stopped"][k] == other["stopped"][k] == "converged":
            deviation = (energy - least) / max(least, 1e-5 * strain ** 2 * _bending(weave))
            yield abs(deviation) if both_ways else max(0.0, deviation)


def _image_of(layout: Dict[str, Any], image: Any) -> bool:
    """Whether the map preserves the crossings: their places, the directions of their strands, and which strands slide."""
    lattice = np.array(layout["lattice"])
    inverse = np.linalg.inv(lattice)
    if np.max(np.abs(lattice @ image.T @ inverse - np.rint(lattice @ image.T @ inverse))) > 1e-6:
        return False
    lines = [_members(layout, crossing) for crossing in layout["crossings"]]
    places = np.array([crossing["position"] for crossing in layout["crossings"]])

    def found(shift: Any) -> bool:
        for place, members in zip(places, lines):
            apart = (places - image @ place - shift) @ inverse
            near = np.flatnonzero(np.max(np.abs(apart - np.rint(apart)), axis=1) < 1e-5)
            moved = [(float(np.mod(np.arctan2(*(image @ np.array([np.cos(a), np.sin(a)]))[::-1]), np.pi)), slides) for a, slides in members]
            if not any(_alike(moved, lines[k]) for k in near):
                return False
        return True

    return any(found(place - image @ places[0]) for place in places)


def _members(layout: Dict[str, Any], crossing: Dict[str, Any]) -> List[Tuple[float, bool]]:
    found = []
    for member in crossing["members"]:
        line = np.array(layout["strands"][member["strand"]]["polyline"])
        lengths = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
        k = int(np.clip(np.searchsorted(lengths * layout["strands"][member["strand"]]["length"] / lengths[-1], member["coordinate"]) - 1, 0, len(line) - 2))
        along = line[k + 1] - line[k]
        found.append((float(np.mod(np.arctan2(along[1], along[0]), np.pi)), bool(member["slides"])))
    return found


def _alike(one: List[Tuple[float, bool]], other: List[Tuple[float, bool]]) -> bool:
    """Whether the strands at two crossings agree. The directions of polylines are those of chords, so that they agree only roughly."""
    near = lambda a, b: abs((a - b + np.pi / 2) % np.pi - np.pi / 2) < 0.1  # noqa: E731
    return len(one) == len(other) and any(all(near(a[0], b[0]) and a[1] == b[1] for a, b in zip(one, order)) for order in itertools.permutations(other))


def _symmetries(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    weave, directions = drawn["weaves"][0], drawn["directions"]
    base = _homogenize(server, weave, drawn["strain"], directions)
    yield from _defined(base)
    turn = _homogenize(server, weave, drawn["strain"], [angle + np.pi for angle in directions])
    for deviation in _above(weave, drawn["strain"], base, turn, True):
        yield "half a turn", deviation
    layout = server.post("/v1/weave-layouts", {"weave": weave})
    images = [turned(np.pi / 2)] + [np.array([[np.cos(a), np.sin(a)], [np.sin(a), -np.cos(a)]]) for a in (0, np.pi / 2, np.pi, -np.pi / 2)]
    for image in images:
        if _image_of(layout, image):
            ahead = [float(np.arctan2(*(image @ np.array([np.cos(angle), np.sin(angle)]))[::-1])) for angle in directions]
            for deviation in _above(weave, drawn["strain"], base, _homogenize(server, weave, drawn["strain"], ahead), True):
                yield "symmetry", deviation
            return


def _paths(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    weave, other, strain = drawn["weaves"][0], drawn["other"], drawn["strain"]
    directions = (np.pi * (np.arange(24) + drawn["start"]) / 24).tolist() if drawn["count"] == 24 else drawn["directions"][:drawn["count"]]
    base = _homogenize(server, weave, strain, directions)
    yield from _defined(base)
    if other == "without buckling":
        second = _homogenize(server, weave, strain, directions, effects={"buckling": "off"})
    elif other == "neighbours":
        sides = [_homogenize(server, weave, strain, [angle + turn for angle in directions]) for turn in (-1e-4, 1e-4)]
        second = {"energy_density": np.mean([side["energy_density"] for side in sides], axis=0),
                  "stopped": [one if one == two else "apart" for one, two in zip(*(side["stopped"] for side in sides))]}
    else:
        second = _homogenize(server, weave, strain, directions, accuracy={"load_steps": 4 * int(np.ceil(abs(strain) / 0.04))})
    for deviation in _above(weave, drawn["strain"], base, second):
        yield other, deviation


def _derivative(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    """Compares a difference of energies with the integral of the stress by Simpson's rule over a step of 4e-3, whose error is of fifth order in the step."""
    step = np.array(drawn["step"]).reshape(2, 2)
    step *= 2e-3 / np.linalg.norm(step)
    turn = turned(drawn["directions"][0])
    middle = turn @ np.diag([1 + drawn["strain"] / 4, 1 + drawn["strain"] * drawn["move"][0]]) @ turn.T
    answer = server.post("/v1/weave-deformations", {"weave": drawn["weaves"][0], "deformation_gradients": [(middle + k * step).tolist() for k in (-1, 0, 1)]})
    if any(stopped != "converged" for stopped in answer["stopped"]) or any(answer["branches"]):
        return
    stress = [np.sum(np.array(p) * step) for p in answer["nominal_stress"]]
    rise = (stress[0] + 4 * stress[1] + stress[2]) / 3
    size = np.linalg.norm(step) * np.linalg.norm(answer["nominal_stress"][1])
    yield "derivative", (answer["energy_density"][2] - answer["energy_density"][0] - rise) / size


def _extent(layout: Dict[str, Any]) -> Tuple[Any, Any]:
    points = np.concatenate([np.array(strand["polyline"]) for strand in layout["strands"]])
    return points.min(axis=0), points.max(axis=0)


def _sheet(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    weave = drawn["weaves"][0]
    answers = []
    least, most = _extent(server.post("/v1/weave-layouts", {"weave": weave}))
    for scale in (1.0, drawn["scale"]):
        scaled = _scaled(weave, scale)
        low, high = scale * least, scale * most
        size = high - low
        cut = 0.3 * min(size)
        supports = [{"at": {"box": [(low - 0.1 * size).tolist(), [high[0] + 0.1 * size[0], low[1] + cut]]}},
                    {"at": {"box": [[low[0] - 0.1 * size[0], high[1] - cut], (high + 0.1 * size).tolist()]},
                     "displacement": [drawn["move"][0] * size[1], abs(drawn["move"][1]) * size[1], 0]}]
        answers.append(server.post("/v1/weave-simulations", {"weave": scaled, "supports": supports, "states": SHEET_STATES, "deformed": "none",
                                                             "effects": {"out_of_plane": "off"}}))
    one, two = answers
    states = [state for state in one["states"] if state["stopped"] == "converged"]
    way = np.array([[drawn["move"][0], abs(drawn["move"][1]), 0] if place["support"] == 1 else [0, 0, 0] for place in one["supports"]]) * (most - least)[1]
    for state in states:
        reactions = np.array(state["reactions"])
        yield "reactions", np.max(np.abs(reactions.sum(axis=0))) / np.max(np.abs(reactions))
    power = [float(np.sum(np.array(state["reactions"]) * way)) for state in states]
    smooth = not any(state["branches"] for state in states)
    for k in range(0, len(states) - 2, 2):
        if smooth:
            rise = (power[k] + 4 * power[k + 1] + power[k + 2]) / 6 * (states[k + 2]["share"] - states[k]["share"])
            yield "work", (states[k + 2]["energy"] - states[k]["energy"] - rise) / abs(rise)
    for first, second in zip(states, two["states"]):
        yield "sheet scales", second["energy"] / drawn["scale"] ** 3 / first["energy"] - 1


def _printed(server: Server, drawn: Dict[str, Any]) -> Optional[Tuple[Dict[str, Any], Dict[str, Any]]]:
    for weave in drawn["weaves"]:
        try:
            return weave, server.post("/v1/weave-toolpaths", {"weave": weave, "overrun": {"start": drawn["overrun"][0], "end": drawn["overrun"][1]},
                                                              "include": ["gcode", "moves"]})
        except Refusal as refusal:
            if refusal.code != "weave.not_printable":
                raise
    return None


def _print(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    printed = _printed(server, drawn)
    if printed is None:
        return
    weave, answer = printed
    statistics, check = answer["statistics"], answer["check"]
    own = _gcode.read(answer["gcode"])
    yield "own check", check["violation_count"]
    for said, length in ((statistics["extruded_length"], own.extruded), (check["extruded_length"], own.extruded), (statistics["filament"], own.filament),
                         (check["filament"], own.filament), (check["travel_length"], own.travelled), (check["minutes"], own.minutes)):
        yield "printed lengths", said / length - 1
    lengths: Dict[str, float] = {}
    volume = 0.0
    for move in answer["moves"]:
        length = float(np.sum(np.linalg.norm(np.diff(np.array(move["points"]), axis=0), axis=1)))
        lengths[move["kind"]] = lengths.get(move["kind"], 0.0) + length
        volume += length * move["area"]
    yield "printed volume", own.filament * np.pi * 1.75 ** 2 / 4 / volume - 1
    for kind in ("strand", "lifted", "channel", "support", "priming", "travel"):
        if statistics[f"{kind}_length"] or lengths.get(kind):
            yield "printed lengths", lengths.get(kind, 0.0) / statistics[f"{kind}_length"] - 1
    yield from _laid(server, weave, drawn, answer)


def _laid(server: Server, weave: Dict[str, Any], drawn: Dict[str, Any], answer: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    """Compares the moves of each strand with the strand of the layout, at any position on the bed."""
    layout = server.post("/v1/weave-layouts", {"weave": weave})
    tracks: Dict[int, List[Any]] = {}
    for move in answer["moves"]:
        if move["kind"] in ("strand", "lifted"):
            tracks.setdefault(move["strand"], []).append(np.array(move["points"])[:, :2])
    origin = _origin(layout, tracks, drawn["overrun"])
    for index, strand in enumerate(layout["strands"]):
        line = np.array(strand["polyline"]) + origin
        track = np.concatenate(tracks[index])
        more = sum(drawn["overrun"]) if strand["ends"] == "open" else 0.0
        plane = sum(float(np.sum(np.linalg.norm(np.diff(part, axis=0), axis=1))) for part in tracks[index])
        yield "whole strands", (plane - more) / strand["length"] - 1
        ends = np.array([drawn["overrun"][0], drawn["overrun"][1]]) if strand["ends"] == "open" else np.zeros(2)
        longer = np.concatenate([[line[0] + ends[0] * _unit(line[0] - line[1])], line, [line[-1] + ends[1] * _unit(line[-1] - line[-2])]])
        chords = _chord_error(np.array(strand["polyline"]))
        yield "printed strands", max(0.0, max(_distance(point, longer) for point in track[:: max(1, len(track) // 40)]) - 0.005 - chords)


def _unit(vector: Any) -> Any:
    return vector / np.linalg.norm(vector)


def _origin(layout: Dict[str, Any], tracks: Dict[int, List[Any]], overrun: List[float]) -> Any:
    """Position on the bed of the weave's (0, 0). The print of the first strand begins at its first point, or at a known distance before it."""
    strand = layout["strands"][0]
    line, track = np.array(strand["polyline"]), np.concatenate(tracks[0])
    if strand["ends"] == "open":
        starts = [line[0] + overrun[0] * _unit(line[0] - line[1]), line[-1] + overrun[1] * _unit(line[-1] - line[-2])]
        options = [track[0] - start for start in starts]
    else:
        options = [np.array([(track[:, axis].min() + track[:, axis].max() - line[:, axis].min() - line[:, axis].max()) / 2 for axis in (0, 1)])]
    return min(options, key=lambda origin: max(_distance(point, line + origin) for point in track[:: max(1, len(track) // 10)]))


def _chord_error(line: Any) -> float:
    """Estimated distance of a polyline's chords from the curve that it approximates: length times angle over 8, at the sharpest corner."""
    sides = np.diff(line, axis=0)
    lengths = np.linalg.norm(sides, axis=1)
    turns = np.abs([np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b) for a, b in zip(sides, sides[1:])] or [0.0])
    return float(np.max(lengths) * np.max(turns[turns < 0.3], initial=0.0) / 8)


def _distance(point: Any, line: Any) -> float:
    sides = np.diff(line, axis=0)
    squares = np.maximum(np.einsum("ij,ij->i", sides, sides), 1e-300)
    share = np.clip(np.einsum("ij,ij->i", point - line[:-1], sides) / squares, 0, 1)
    return float(np.min(np.linalg.norm(line[:-1] + share[:, None] * sides - point, axis=1)))
