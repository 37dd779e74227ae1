"""Searches for designs: derived values of the answers are computed again, and profiles from the model's energies by the suite's own Newton's method."""

from __future__ import annotations

from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from _tilings import FAMILIES, NO_STRUCTURE, draws, parameters_at
from truth import Check, Refusal, Server

ABOUT = ("Random targets of all tasks, with weights, bands, further targets, materials, orientations, sizes and limits. Targets, deviations and sizes are computed again; profiles are "
         "equilibria of the model's stresses, found by the suite's own Newton's method; turned and stiffer designs answer as the rules say; a list of materials is no worse than its best.")

CHECKS = {
    "samples": Check("places of the samples, beside even ones", 1e-12, "plain difference"),
    "target": Check("target at the samples, beside own splines", 1e-9, "of the target's largest value"),
    "monotone target": Check("monotone targets beyond the control points between which they run, or against their sense", 1e-12, "of the target's largest value"),
    "deviation": Check("`relative_rms` and `max`, computed from the profiles", 1e-9, "plain difference, or of the target's largest value"),
    "reached": Check("samples and designs that are called reached or not against the rule", 0, "count"),
    "ranking": Check("the answer beside the first of the ranking, and the ranking's order", 1e-12, "plain difference"),
    "profile": Check("the profile of the design that is answered, beside a request for it", 1e-6, "of its largest value"),
    "bars": Check("error bars of a design all of whose parameters are given, beside those of its profile and of the model's uniaxial loads; of a design that was found, beside its profile, "
                  "where the model has none of its own for searches", 1e-6, "of the largest value"),
    "equilibrium": Check("profile beside own equilibria of the model's stresses", 1e-6, "of its largest value"),
    "in range": Check("samples in range whose bar is null or longer than the model says it trusts, or of parameters beyond the bounds that it names", 0, "count"),
    "turned": Check("profile of a turned design beside that of the straight one along a turned direction", 1e-6, "of its largest value"),
    "stiffer": Check("profile and bars over Young's modulus, Poisson's ratio as it is", 1e-9, "of the largest value"),
    "materials": Check("deviation of a list of materials beyond that of its best, unless it reaches the target", 1e-6, "plain difference"),
    "best modulus": Check("what another Young's modulus of the range takes off the sum of squares without bands", 1e-5, "of the target's squares"),
    "size": Check("cell size, beam width, relative density and density, computed from the structure", 1e-9, "of it"),
    "limits": Check("relative density beyond its limits", 0, "plain difference"),
}

KINDS = (("search", 0.5), ("profile", 0.26), ("rules", 0.14), ("materials", 0.1))
QUANTITIES = {"stress_strain": "stress", "stiffness": "stiffness", "poisson": "poisson"}
"""The name of each task's values in the model's description."""
DATA_MODULUS = 26.0
"""Young's modulus of the models' data, in MPa."""


def case(rng: np.random.Generator) -> Dict[str, Any]:
    kind = str(rng.choice([name for name, _ in KINDS], p=[share for _, share in KINDS]))
    count = int(rng.integers(1, 3)) if kind == "search" and rng.uniform() < 0.3 else 0
    low, high = np.sort(10 ** rng.uniform(0.3, 3.5, size=2))
    return {"kind": kind, "family": str(rng.choice(FAMILIES)), "shares": draws(rng)[0], "targets": [_target(rng) for _ in range(1 + count)],
            "orientation": float(rng.uniform(-np.pi, np.pi)), "turns": bool(rng.uniform() < 0.5), "modulus": float(10 ** rng.uniform(0, 3.5)),
            "material": bool(rng.uniform() < 0.4), "range": [float(low), float(high)] if rng.uniform() < 0.4 else None, "density": float(rng.uniform(0.8, 3)),
            "moduli": [sorted(float(part) for part in 10 ** rng.uniform(0.3, 3, size=2)) if rng.uniform() < 0.6 else float(10 ** rng.uniform(0.3, 3)) for _ in range(3)],
            "size": str(rng.choice(["none", "beam_width", "cell_size"])), "length": float(rng.uniform(0.2, 2)),
            "limits": sorted(float(part) for part in rng.uniform(0.05, 0.5, size=2)) if rng.uniform() < 0.2 else None}


def _target(rng: np.random.Generator) -> Dict[str, Any]:
    task = str(rng.choice(["stress_strain", "stiffness", "poisson"], p=[0.5, 0.3, 0.2]))
    measure = str(rng.choice(["green", "engineering"]))
    count = int(rng.integers(2, 7))
    shares = np.cumsum(rng.uniform(0.2, 1, size=count))
    shares = (shares - shares[0]) / (shares[-1] - shares[0])
    problem: Dict[str, Any] = {"task": task, "strain_measure": measure, "weight": float(rng.uniform(0.2, 3))}
    if task == "stress_strain":
        problem["direction"] = float(rng.uniform(-np.pi, np.pi))
        first = float(rng.choice([0.0, rng.uniform(-0.1, -0.02)]))
        x = first + (float(rng.uniform(0.05, 0.15)) - first) * shares
        y = x * rng.uniform(0.3, 4) * (1 + 0.5 * rng.uniform(-1, 1, size=count))
    else:
        problem["strain"] = float(rng.uniform(0.01, 0.1))
        x = rng.uniform(0, 1) + shares * rng.uniform(1, 3)
        y = rng.uniform(0.5, 6, size=count) if task == "stiffness" else rng.uniform(-0.5, 0.9, size=count)
    spline: Dict[str, Any] = {"control_points": np.stack([x, y], axis=1).tolist(), "interpolation": str(rng.choice(["cubic", "linear", "monotone"]))}
    if rng.uniform() < 0.4:
        spline["weights"] = rng.uniform(0.1, 3, size=count).tolist()
    if rng.uniform() < 0.3:
        spline["bands"] = (rng.uniform(0, 0.1, size=count) * np.max(np.abs(y))).tolist()
    problem["target"] = spline
    if rng.uniform() < 0.6:
        problem["samples"] = int(rng.integers(3, 25))
    return problem


def examine(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    yield from {"search": _search, "profile": _profile, "rules": _rules, "materials": _materials}[drawn["kind"]](server, drawn)


def _over_directions(problem: Dict[str, Any]) -> bool:
    return bool(problem["task"] != "stress_strain")


def _linear(problem: Dict[str, Any], values: Any, x: Any) -> Any:
    """Linear interpolation between control points. Over directions the first point follows the last one, half a turn later."""
    places = np.array(problem["target"]["control_points"])[:, 0]
    if _over_directions(problem):
        return np.interp(x, places, values, period=np.pi)
    return np.interp(x, places, values)


def _cubic(problem: Dict[str, Any], x: Any) -> Any:
    places, values = np.array(problem["target"]["control_points"]).T
    if not _over_directions(problem):
        if len(places) == 2:
            return _linear(problem, values, x)
        spline: BSpline = make_interp_spline(places, values, k=3, bc_type="natural")
        return spline(x)
    places, values = np.append(places, places[0] + np.pi), np.append(values, values[0])
    closed: BSpline = make_interp_spline(places, values, k=3, bc_type="periodic")
    return closed(places[0] + np.mod(np.array(x) - places[0], np.pi))


def _targets_again(problem: Dict[str, Any], profile: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    x, target = np.array(profile["x"]), np.array(profile["target"])
    places, values = np.array(problem["target"]["control_points"]).T
    size = np.max(np.abs(values))
    if _over_directions(problem):
        count = problem.get("samples", 50)
        yield "samples", np.max(np.abs(np.diff(x, append=x[0] + np.pi) - np.pi / count)) if len(x) == count else np.nan
    else:
        count = problem.get("samples", 10)
        yield "samples", np.max(np.abs(x - np.linspace(places[0], places[-1], count))) if len(x) == count else np.nan
    if problem["target"]["interpolation"] == "linear":
        yield "target", np.max(np.abs(target - _linear(problem, values, x))) / size
    elif problem["target"]["interpolation"] == "cubic":
        yield "target", np.max(np.abs(target - _cubic(problem, x))) / size
    else:
        yield "monotone target", _beyond_neighbours(problem, x, target) / size


def _beyond_neighbours(problem: Dict[str, Any], x: Any, target: Any) -> float:
    places, values = np.array(problem["target"]["control_points"]).T
    if _over_directions(problem):
        places, values = np.append(places, places[0] + np.pi), np.append(values, values[0])
        x = places[0] + np.mod(x - places[0], np.pi)
    k = np.clip(np.searchsorted(places, x, side="right") - 1, 0, len(places) - 2)
    low, high = np.minimum(values[k], values[k + 1]), np.maximum(values[k], values[k + 1])
    worst = float(np.max(np.maximum(np.maximum(low - target, target - high), 0)))
    order = np.argsort(x)
    for i, j in zip(order, order[1:]):
        if k[i] == k[j]:
            worst = max(worst, float(-np.sign(values[k[i] + 1] - values[k[i]]) * (target[j] - target[i])))
    return worst


def _deviation(problem: Dict[str, Any], profile: Dict[str, Any]) -> Tuple[float, float, Any, float]:
    """Relative root mean square deviation, largest deviation, all deviations, and the root mean square of the target."""
    x, target, achieved = (np.array(profile[key]) for key in ("x", "target", "achieved"))
    count = len(problem["target"]["control_points"])
    weights = np.maximum(_linear(problem, np.array(problem["target"].get("weights", np.ones(count))), x), 0)
    weights = weights / weights.sum()
    bands = _linear(problem, np.array(problem["target"].get("bands", np.zeros(count))), x)
    beyond = np.maximum(0, np.abs(achieved - target) - bands)
    scale = float(np.sqrt(np.sum(weights * target ** 2)))
    if problem["task"] == "poisson":
        scale = max(scale, 0.1)
    return float(np.sqrt(np.sum(weights * beyond ** 2))) / scale, float(np.max(beyond)), beyond, scale


def _body(drawn: Dict[str, Any]) -> Dict[str, Any]:
    main, *also = drawn["targets"]
    body: Dict[str, Any] = {**main, "family": drawn["family"], "also": also, "accuracy": {"starts": 1, "candidates": 16, "max_iterations": 30},
                            "effects": {"ways_out": "off"}}
    if drawn["turns"]:
        body["orientation"] = drawn["orientation"]
    if drawn["material"]:
        body["material"] = {"youngs_modulus": drawn["range"] or drawn["modulus"], "density": drawn["density"]}
    if drawn["size"] != "none":
        body[drawn["size"]] = drawn["length"] * (1 if drawn["size"] == "beam_width" else 10)
    if drawn["limits"]:
        body["limits"] = {"relative_density": drawn["limits"]}
    return body


def _search(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    try:
        answer = server.post("/v1/designs", _body(drawn))
    except Refusal as refusal:
        if refusal.code not in ("design.beyond_limits", "design.no_equilibrium"):
            raise
        return
    profiles = [answer["profile"], *answer["also"]]
    squares = weights = 0.0
    all_reached = True
    for number, (problem, profile) in enumerate(zip(drawn["targets"], profiles)):
        yield from _targets_again(problem, profile)
        relative, largest, beyond, scale = _deviation(problem, profile)
        squares += problem["weight"] * relative ** 2
        weights += problem["weight"]
        if number == 0:
            yield "deviation", (answer["error"]["max"] - largest) / np.max(np.abs(profile["target"]))
        tolerance = max(0.01 * scale, 0.02 if problem["task"] == "poisson" else 0)
        clear = np.abs(beyond - tolerance) > 1e-9 * scale
        yield "reached", float(np.sum(clear & ((beyond <= tolerance) != np.array(profile["reached"]))))
        all_reached = all_reached and all(profile["reached"])
        yield from _ranged(_description(server, drawn), answer["parameters"], problem["task"], profile["achieved"], profile["error_bar"], profile["in_range"])
    yield "deviation", answer["error"]["relative_rms"] - np.sqrt(squares / weights)
    yield "reached", float(all_reached != answer["reached"])
    first = answer["ranking"][0]
    yield "ranking", np.max(np.abs(np.array(first["parameters"]) - answer["parameters"]))
    yield "ranking", first["error"]["relative_rms"] - answer["error"]["relative_rms"]
    yield from _asked_again(server, drawn, answer, profiles)
    yield from _sized(server, drawn, answer)
    if drawn["material"] and drawn["range"] and len(profiles) == 1 and "bands" not in drawn["targets"][0]["target"]:
        yield "best modulus", _better_modulus(drawn, answer)


def _description(server: Server, drawn: Dict[str, Any]) -> Dict[str, Any]:
    """The description of the model of the family in the request; the tested answer is not used to identify it."""
    (model,) = [model for model in server.get("/v1/models")["models"] if model["family"] == drawn["family"]]
    assert isinstance(model, dict)
    return model


def _within(model: Dict[str, Any], parameters: Any) -> bool:
    least, most = (np.array(model["parameters"][end]) for end in ("lower", "upper"))
    return bool(np.all(np.abs(np.array(parameters) - (least + most) / 2) <= (most - least) / 2 * (1 + 1e-9)))


def _ranged(model: Dict[str, Any], parameters: Any, task: str, values: Any, bars: Any, in_range: Any) -> Iterator[Tuple[str, float]]:
    within, trusted = _within(model, parameters), model["error_bars"][QUANTITIES[task]]["trusted"]
    wrong = 0
    for value, bar, inside in zip(values, bars, in_range):
        if inside:
            longest = trusted * (abs(value) if task != "poisson" else 1)
            wrong += not within or bar is None or bar > longest * (1 + 1e-9) + 1e-12
    yield "in range", float(wrong)


def _profile_body(problem: Dict[str, Any], answer: Dict[str, Any], x: Any) -> Dict[str, Any]:
    body = {key: problem[key] for key in ("task", "direction", "strain", "strain_measure") if key in problem}
    return {**body, "family": answer["family"], "parameters": answer["parameters"], "x": list(x)}


def _asked_again(server: Server, drawn: Dict[str, Any], answer: Dict[str, Any], profiles: List[Dict[str, Any]]) -> Iterator[Tuple[str, float]]:
    for problem, profile in zip(drawn["targets"], profiles):
        again = server.post("/v1/profiles", {**_profile_body(problem, answer, profile["x"]), "orientation": answer["orientation"],
                                             "material": {"youngs_modulus": answer["material"]["youngs_modulus"]}})
        yield "profile", _apart(again["y"], profile["achieved"])
        if "searched" not in _description(server, drawn)["error_bars"][QUANTITIES[problem["task"]]]:
            yield "bars", _apart(again["error_bar"], profile["error_bar"])


def _apart(one: Any, other: Any) -> float:
    """The largest difference over the largest value; a missing value must be missing in both."""
    a, b = (np.array([np.nan if value is None else value for value in values], dtype=float) for values in (one, other))
    if len(a) != len(b) or np.any(np.isnan(a) != np.isnan(b)):
        return float("nan")
    present = ~np.isnan(a)
    return float(np.max(np.abs(a - b)[present], initial=0) / max(np.max(np.abs(b)[present], initial=0), 1e-12))


def _sized(server: Server, drawn: Dict[str, Any], answer: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    said = answer["structure"]
    try:
        structure = server.post("/v1/structures", {"family": answer["family"], "parameters": answer["parameters"], "beam_width": said["beam_width"]})
    except Refusal as refusal:
        if refusal.code not in NO_STRUCTURE:
            raise
        yield "size", float("There is no such structure" not in answer["message"] or said["cell_size"] is not None)
        return
    yield "size", said["cell_size"] / np.sqrt(abs(np.linalg.det(structure["lattice"]))) - 1
    yield "size", said["relative_density"] / (structure["solid_area"] / abs(np.linalg.det(structure["lattice"]))) - 1
    yield "size", said["density"] / (said["relative_density"] * (drawn["density"] if drawn["material"] else 1.2)) - 1
    asked = {"none": 0.3, "beam_width": drawn["length"], "cell_size": 10 * drawn["length"]}[drawn["size"]]
    yield "size", said["cell_size" if drawn["size"] == "cell_size" else "beam_width"] / asked - 1
    if drawn["limits"]:
        yield "limits", max(0.0, drawn["limits"][0] - said["relative_density"], said["relative_density"] - drawn["limits"][1])


def _better_modulus(drawn: Dict[str, Any], answer: Dict[str, Any]) -> float:
    """Deviation from the best modulus. Without bands this is a quotient of scalar products, clamped to the range."""
    problem, profile = drawn["targets"][0], answer["profile"]
    if problem["task"] == "poisson":
        return 0.0
    x, target, achieved = (np.array(profile[key]) for key in ("x", "target", "achieved"))
    weights = _linear(problem, np.array(problem["target"].get("weights", np.ones(len(problem["target"]["control_points"])))), x)
    factor = np.sum(weights * target * achieved) / np.sum(weights * achieved ** 2)
    modulus = answer["material"]["youngs_modulus"]
    factor = np.clip(factor * modulus, *drawn["range"]) / modulus
    gained = np.sum(weights * (achieved - target) ** 2) - np.sum(weights * (factor * achieved - target) ** 2)
    return float(gained / np.sum(weights * target ** 2))


def _places(problem: Dict[str, Any]) -> List[float]:
    if _over_directions(problem):
        return (np.pi * np.arange(8) / 8 + 0.1).tolist()
    ends = np.array(problem["target"]["control_points"])[[0, -1], 0]
    return np.linspace(*ends, 7).tolist()


def _profile(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    problem = drawn["targets"][0]
    design = {"family": drawn["family"], "parameters": parameters_at(server, drawn["family"], drawn["shares"])}
    model = _description(server, drawn)
    answer = server.post("/v1/profiles", _profile_body(problem, design, _places(problem)))
    yield from _ranged(model, design["parameters"], problem["task"], answer["y"], answer["error_bar"], answer["in_range"])
    yield from _given(server, model, design, problem)
    own = _own_profile(server, model["id"], design["parameters"], problem, answer["x"])
    if own is not None and all(value is not None for value in answer["y"]):
        yield "equilibrium", _apart(answer["y"], own)


def _given(server: Server, model: Dict[str, Any], design: Dict[str, Any], problem: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    """Compares the error bars of a given design from three kinds of requests. Designs beyond the model's bounds are refused."""
    if not _within(model, design["parameters"]):
        return
    told = server.post("/v1/designs", {**problem, "family": design["family"], "initial": design["parameters"], "fixed": design["parameters"],
                                         "effects": {"ways_out": "off"}})["profile"]
    asked = server.post("/v1/profiles", _profile_body(problem, design, told["x"]))
    yield "bars", _apart(told["error_bar"], asked["error_bar"])
    if problem["task"] == "stress_strain":
        yield "bars", _apart(asked["error_bar"], _uniaxial_bars(server, model["id"], design["parameters"], problem, told["x"]))


def _uniaxial_bars(server: Server, model: str, parameters: List[float], problem: Dict[str, Any], x: Any) -> List[Optional[float]]:
    """Error bars of the stress at each strain, from two paths that begin at rest."""
    found: Dict[float, Optional[float]] = {}
    for sense in (-1, 1):
        strains = sorted((strain for strain in x if strain * sense > 0 or (strain == 0 and sense > 0)), key=abs)
        if strains:
            stretches = [1 + strain if problem["strain_measure"] == "engineering" else float(np.sqrt(1 + 2 * strain)) for strain in strains]
            states = server.post(f"/v1/models/{model}/uniaxial", {"parameters": parameters, "direction": problem["direction"], "stretches": stretches})["states"]
            for strain, stretch, state in zip(strains, stretches, states):
                bar = state["error_bar"]
                found[strain] = None if bar is None else bar * (stretch if problem["strain_measure"] == "engineering" else 1)
    return [found[strain] for strain in x]


def _own_profile(server: Server, model: str, parameters: List[float], problem: Dict[str, Any], x: Any) -> Optional[List[float]]:
    """The profile for all samples at once, each followed from rest in small steps. None if Newton's method does not converge."""
    x = np.array(x)
    directions = x if _over_directions(problem) else np.full(len(x), problem["direction"])
    strains = np.full(len(x), problem["strain"]) if _over_directions(problem) else x
    stretches = 1 + strains if problem["strain_measure"] == "engineering" else np.sqrt(1 + 2 * strains)
    d, n = np.stack([np.cos(directions), np.sin(directions)]), np.stack([-np.sin(directions), np.cos(directions)])
    along, across = np.stack([d[0] ** 2, d[1] ** 2, d[0] * d[1]]).T, np.stack([n[0] ** 2, n[1] ** 2, n[0] * n[1]]).T
    shear = np.stack([d[0] * n[0], d[1] * n[1], (d[0] * n[1] + d[1] * n[0]) / 2]).T
    free = np.zeros((len(x), 2))
    doubled = np.array([1, 1, 2])
    stress = tangent = np.zeros(0)
    steps = max(2, int(np.ceil(np.max(np.abs((stretches ** 2 - 1) / 2)) / 0.01)))
    for step in range(1, steps + 1):
        green = (stretches ** 2 - 1) / 2 * step / steps
        for _ in range(25):
            strain = green[:, None] * along + free[:, :1] * across + 2 * free[:, 1:] * shear
            answer = server.post(f"/v1/models/{model}/evaluations", {"parameters": [parameters], "green_strain": strain.tolist(), "derivatives": 2})
            stress, tangent = np.array(answer["stress"]), np.array(answer["tangent"])
            modes = np.stack([across * doubled, 2 * shear * doubled], axis=1)
            residual = np.einsum("kij,kj->ki", modes, stress)
            size = np.linalg.norm(stress, axis=1) + 1e-3 * np.linalg.norm(tangent, axis=(1, 2))
            if np.max(np.linalg.norm(residual, axis=1) / size) < 1e-11:
                break
            newton = np.linalg.solve(np.einsum("kia,kab,kjb->kij", modes, tangent, modes), residual[..., None])[..., 0]
            free = free - newton * np.minimum(1, 0.02 / np.maximum(np.linalg.norm(newton, axis=1), 1e-300))[:, None]
        else:
            return None
    if problem["task"] == "stress_strain":
        value = np.einsum("ki,ki->k", along * doubled, stress)
        return (value * stretches if problem["strain_measure"] == "engineering" else value).tolist()
    compliance = np.linalg.inv(tangent)
    lengthwise = np.einsum("ki,kij,kj->k", along, compliance, along)
    if problem["task"] == "stiffness":
        return (1 / lengthwise).tolist()
    return (-np.einsum("ki,kij,kj->k", across, compliance, along) / lengthwise).tolist()


def _rules(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    problem, turn = drawn["targets"][0], drawn["orientation"]
    design = {"family": drawn["family"], "parameters": parameters_at(server, drawn["family"], drawn["shares"])}
    x = np.array(_places(problem))
    body = _profile_body(problem, design, x)
    base = server.post("/v1/profiles", body)
    if _over_directions(problem):
        turned = server.post("/v1/profiles", {**body, "orientation": turn, "x": (x + turn).tolist()})
    else:
        turned = server.post("/v1/profiles", {**body, "orientation": turn, "direction": problem["direction"] + turn})
    yield "turned", _apart(turned["y"], base["y"])
    yield "turned", float(turned["in_range"] != base["in_range"])
    factor = drawn["modulus"] / DATA_MODULUS
    stiffer = server.post("/v1/profiles", {**body, "material": {"youngs_modulus": drawn["modulus"]}})
    for key in ("y", "error_bar"):
        scaled = [None if value is None else value / (1 if problem["task"] == "poisson" else factor) for value in stiffer[key]]
        yield "stiffer", _apart(scaled, base[key])


def _materials(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    body = {**drawn["targets"][0], "family": drawn["family"], "accuracy": {"starts": 4}, "effects": {"trust": "off", "ways_out": "off"}}
    materials = [{"youngs_modulus": modulus} for modulus in drawn["moduli"]]
    answer = server.post("/v1/designs", {**body, "material": materials})
    if answer["reached"]:
        return
    best = min(server.post("/v1/designs", {**body, "material": material})["error"]["relative_rms"] for material in materials)
    yield "materials", max(0.0, answer["error"]["relative_rms"] - best)
