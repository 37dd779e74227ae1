"""The classes of requests and answers against api/openapi.yaml."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, Set, Tuple, Union, get_args, get_origin

import numpy as np
import pytest
import yaml
from jsonschema import Draft202012Validator, RefResolver

import supple
from supple.jobs import JobStatus
from supple.points import PlacedPoint
from supple.request import FileRequest, Request
from supple.wire import REQUIRED, Member, Sent, Shape, fields_of

CONTRACT: Dict[str, Any] = yaml.safe_load((Path(__file__).parents[3] / "api" / "openapi.yaml").read_text(encoding="utf-8"))
SCHEMAS = CONTRACT["components"]["schemas"]
REQUESTS = [one for one in (getattr(supple, name) for name in supple.__all__)
            if isinstance(one, type) and issubclass(one, Request) and one not in (Request, FileRequest)]
ANSWERS = [(request._result, CONTRACT["paths"][request.path]["post"]["responses"]["200"]["content"]["application/json"]["schema"])
           for request in REQUESTS if dataclasses.is_dataclass(request._result)
           and request not in (supple.DesignRequest, supple.RegionsRequest, supple.FieldRequest, supple.GcodeReportRequest)]
DESIGNS = SCHEMAS["DesignResponse"]
ANSWERS += [(kind, {**DESIGNS, "required": DESIGNS["required"] + required}) for kind, required in (
    (supple.DesignResult, SCHEMAS["Design"]["required"]), (supple.RegionDesigns, ["regions"]))]
ANSWERS += [(kind, SCHEMAS[name]) for kind, name in (
    (supple.MeshInfo, "Mesh"), (supple.PatchMesh, "PatchMesh"), (supple.MeshRepair, "MeshRepair"), (supple.Family, "Family"), (supple.AddedFamily, "AddedFamily"), (supple.ModelInfo, "Model"),
    (JobStatus, "Job"), (PlacedPoint, "PlacedPoint"), (supple.Geodesic, "GeodesicResult"), (supple.GcodeReport, "GcodeReport"),
    (supple.PartialDesign, "PartialDesign"), (supple.PartialRound, "PartialRound"),
    (supple.PartialRelaxation, "PartialRelaxation"), (supple.PartialOptimization, "PartialOptimization"),
    (supple.PartialPartState, "PartialPartSimulation"), (supple.PartialTraining, "PartialTraining"))]
ALWAYS_SENT = {"CrossingMember.shift", "CrossingMember.slides", "WeaveSimulation.unknowns"}
"""Members of answers that the server always sends and the contract does not require."""
NOT_OFFERED = {"known_path", "keep", "svg", "format", "panel_scale", "height", "cells"}
"""Members of requests that the package does not offer, or in the request of a file only."""


def resolved(schema: Mapping[str, Any]) -> Mapping[str, Any]:
    while "$ref" in schema:
        schema = {**SCHEMAS[schema["$ref"].rsplit("/", 1)[-1]], **{key: value for key, value in schema.items() if key != "$ref"}}
    return schema


def variants(schema: Mapping[str, Any]) -> List[Mapping[str, Any]]:
    """The schema, or each of those of which a value fulfils one."""
    schema = resolved(schema)
    choices = [one for key in ("oneOf", "anyOf") for one in schema.get(key, ()) if {"type", "$ref", "enum", "const"} & set(one)]
    return [inner for choice in choices for inner in variants(choice)] or [schema]


def members(schema: Mapping[str, Any]) -> Dict[str, Tuple[Mapping[str, Any], bool]]:
    """The members of an object and whether the contract requires them."""
    found: Dict[str, Tuple[Mapping[str, Any], bool]] = {}
    for variant in variants(schema):
        for name, member in variant.get("properties", {}).items():
            found[name] = (member, name in variant.get("required", ()))
    return found


def types_of(schema: Mapping[str, Any]) -> Set[str]:
    found: Set[str] = set()
    for variant in variants(schema):
        named = variant.get("type", "string" if "enum" in variant or "const" in variant else "any")
        found |= {named} if isinstance(named, str) else set(named)
    return found


def place(kind: type, field: Member, schema: Mapping[str, Any]) -> Tuple[Mapping[str, Any], bool]:
    """The schema of a field, wrapped in an array for each "*", and whether the value is always there."""
    columns, always = 0, True
    for depth, part in enumerate(field.at.parts(field.name)):
        if part == "*":
            schema, columns = resolved(resolved(schema)["items"]), columns + 1
            continue
        always = always and (depth == 0 or "null" not in types_of(schema))
        assert part in members(schema), f"{kind.__name__}.{field.name}: the contract has no {part}"
        schema, required = members(schema)[part]
        always = always and (required or columns > 0)
    for _ in range(columns):
        schema = {"type": "array", "items": schema}
    return schema, always and "null" not in types_of(schema)


def check_type(hint: Any, shape: Any, schema: Mapping[str, Any], where: str) -> None:
    """Fails unless all values of the schema fit the type."""
    if hasattr(hint, "__metadata__"):
        shape = next((mark for mark in hint.__metadata__ if isinstance(mark, Shape)), shape)
        hint = hint.__origin__
    if get_origin(hint) is Union:
        check_type(next(one for one in get_args(hint) if one is not type(None)), shape, schema, where)
        return
    names, schema = types_of(schema) - {"null"}, variants(schema)[0]
    if hint in (float, int, bool, str):
        allowed = {float: {"number", "integer"}, int: {"integer"}, bool: {"boolean"}, str: {"string", "any"}}[hint]
        assert names <= allowed, f"{where} is {hint.__name__}, in the contract {names}"
    elif get_origin(hint) is np.ndarray:
        sizes: List[int] = []
        while "array" in types_of(schema):
            schema = resolved(schema)
            sizes.append(schema["minItems"] if schema.get("minItems") == schema.get("maxItems") is not None else -1)
            schema = schema["items"]
        kind = {"f": {"number", "integer"}, "i": {"integer"}, "b": {"boolean"}}[np.dtype(get_args(get_args(hint)[1])[0]).kind]
        assert types_of(schema) - {"null"} <= kind, f"{where} is {hint}, in the contract of {types_of(schema)}"
        assert shape is None or len(shape.sizes) == len(sizes), f"{where} has {len(sizes)} axes in the contract"
        assert shape is None or all(own in (size, -1) for own, size in zip(shape.sizes, sizes)), f"{where}: {sizes} in the contract"
    elif get_origin(hint) is tuple:
        assert names == {"array"}, f"{where} is a tuple, in the contract {names}"
        if "items" in schema:
            check_type(get_args(hint)[0], None, schema["items"], where)
        assert get_args(hint)[1:] == (...,) or schema["minItems"] == schema["maxItems"] == len(get_args(hint)), where
    elif dataclasses.is_dataclass(hint):
        check_answer(hint, schema)
    else:
        assert names == {"object"}, f"{where} is {hint}, in the contract {names}"


def check_answer(kind: Any, schema: Mapping[str, Any]) -> None:
    for field in (one for one in fields_of(kind) if one.at.sent):
        found, always = place(kind, field, schema)
        where = f"{kind.__name__}.{field.name}"
        may_lack = get_origin(field.hint) is Union or field.default is not REQUIRED or field.at.missing is not REQUIRED
        assert always or may_lack or field.at.read or where in ALWAYS_SENT, f"{where}: the contract does not require it"
        if field.at.read is None:
            check_type(field.hint, field.shape, found, where)


@pytest.mark.parametrize("kind, schema", ANSWERS, ids=[kind.__name__ for kind, _ in ANSWERS])
def test_a_class_of_answers_fits_its_schema(kind: Any, schema: Mapping[str, Any]) -> None:
    check_answer(kind, schema)


def sent_members(kind: Any) -> Iterator[Tuple[str, Member]]:
    """The place of each field in the JSON of a class, and those of the objects that are merged into it."""
    for field in fields_of(kind):
        parts = field.at.parts(field.name)
        if field.at.sent and parts:
            yield "/".join(parts), field
        elif field.at.sent:
            for hint in (field.hint, *get_args(field.hint)):
                if isinstance(hint, type) and issubclass(hint, Sent):
                    yield from sent_members(hint)


@pytest.mark.parametrize("request_class", REQUESTS, ids=[one.__name__ for one in REQUESTS])
def test_a_class_of_requests_offers_what_its_schema_does(request_class: Any) -> None:
    body = CONTRACT["paths"][request_class.path]["post"]["requestBody"]["content"]["application/json"]["schema"]
    places = dict(sent_members(request_class))
    for where, field in places.items():
        schema, required = body, True
        for part in where.split("/"):
            schema, required = members(schema)[part]
        if field.default is REQUIRED:
            continue
        assert not required or isinstance(field.default, (int, float, str)) or "oneOf" in body, f"{where} is required"
        if field.default not in (None, (), {}):
            default = resolved(schema).get("default")
            assert default == (list(field.default) if isinstance(field.default, tuple) else field.default), where
    if issubclass(request_class, FileRequest):
        return
    known = {"membrane", "triangles"} if request_class is supple.RelaxationRequest else set()
    known |= {"text", "content"} if request_class is supple.MeasuredCurveRequest else {"regions"}
    known |= {where.split("/")[0] for where, _ in sent_members(supple.Region)} if request_class is supple.RegionsRequest else set()
    offered = {part for where in places for part in where.split("/")} | known | NOT_OFFERED
    assert set(members(body)) <= offered, f"not offered: {set(members(body)) - offered}"
    for group in ("accuracy", "effects", "sliding", "specimen", "mesh"):
        inside = set(members(members(body).get(group, ({}, False))[0]))
        assert inside <= offered, f"not offered in {group}: {inside - offered}"


UNIT = re.compile(r"\b(mm|MPa|[Rr]adians|[Ss]econds|newtons)\b")
WITHOUT_UNITS = {"accuracy/tolerance", "sliding/regularization"}
"""Numbers in whose description there are units, but not of theirs; and N/mm, which is none that texts may have."""


@pytest.mark.parametrize("request_class", REQUESTS, ids=[one.__name__ for one in REQUESTS])
def test_each_quantity_of_a_request_may_have_a_unit(request_class: Any) -> None:
    body = CONTRACT["paths"][request_class.path]["post"]["requestBody"]["content"]["application/json"]["schema"]
    for where, field in sent_members(request_class):
        schema = body
        for part in where.split("/"):
            schema, _ = members(schema)[part]
        has_unit = UNIT.search(resolved(schema).get("description", "")) and types_of(schema) & {"number", "array"}
        assert not has_unit or field.dimensions or where in WITHOUT_UNITS, f"{where}: {resolved(schema)['description']}"


TARGET = supple.Target("stress_strain", [(0, 0), (0.1, 1)], direction=0.5, strain_measure="engineering", interpolation="linear",
                       weights=[1, 2], bands=(0, 0.1), samples=5, weight=2)
MESH, WEAVE = "a" * 64, supple.Weave.regular("slides_y", sheet=(5, 4), fused_border=1).fuse(1).slide(2, 0, forward=1.0)
SHELL = supple.Shell(0.01, 1e4, 0.48, 1e3, 1.1, [4, 7], {3: (0, 0, 1)})
SOLID = supple.Solid(50, element_size=0.2, gravity=(0, 0, -1), regions=[supple.SolidRegion((0, 0, 0), (1, 1, 1), 5)])
STRANDS = [supple.Strand(np.array([[0, 0], [4, 0]])), supple.Strand([(1, 1)], "periodic", (8, 0), 0.5)]
LOADS = [supple.GreenStrain([[0.1, 0, 0]]), supple.Uniaxial(0.5, [1.1], "material"), supple.Biaxial(0.5, [(1.1, 0.9)])]
SAMPLES: List[Request[Any]] = [
    supple.GeodesicsRequest(MESH, [(0, supple.SpacePoint(0, 1, 2)), ((3, (0.2, 0.3, 0.5)), 4)], 2, True, "on", 0.1, 5.0),
    supple.FieldRequest(MESH, [0], 0.1, "edge_graph", 2.0),
    supple.KarcherMeanRequest(MESH, [0, 1], np.ones(2), 1e-6, "lbfgs", 3, 2, 9, "off"),
    supple.ExponentialMapRequest(MESH, 0, [0.1, 0.2], False),
    *(supple.RelaxationRequest(MESH, [0, 1, 2], [(0, 1), supple.Spring(1, 2, 0.5, 3)], [0], supple.Membrane([(0, 1, 2)], 3), host,
                               supple.RelaxationOptions("lbfgs", "euclidean", 1e-6, 5, "on", 0.1, "off", "off"), paths=True)
      for host in (SHELL, SOLID, supple.Moving([np.eye(3)]))),
    supple.NetworkFileRequest(MESH, supple.PoissonDisk(0.1, 3), supple.VoronoiDual(0.1), membrane=supple.Membrane()),
    supple.RelaxationRequest(MESH, supple.PointsInFaces(), supple.AdjacentFaces()),
    supple.VoronoiRequest(MESH, supple.RandomSites(5, 2), relative_error=0.1, pieces=True, statistics=False),
    supple.VoronoiFileRequest(MESH, [0, 1], kind="svg", panel_scale=250.0),
    supple.VoronoiOptimizationRequest(MESH, [0, 1], {"planarity": 2}, [1], supple.VoronoiOptions(0.5, "lbfgs", 1e-4, 7, 1e-2)),
    supple.FamilyCheckRequest({"id": "own", "description": "Hexagons", "parameters": [], "beam_width": 0.1, "isohedral_type": 20}, [0.5]),
    supple.FamilyAtlasRequest("IH21", samples=16, mesh_size=0.5, error_samples=2, crossings=False, recompute=True),
    supple.FamilyAtlasRequest(isohedral_type=16),
    supple.FamilyAtlasRequest(definition={"id": "own", "description": "Hexagons", "parameters": [], "beam_width": 0.1, "isohedral_type": 20}),
    supple.TrainingPlanRequest("IH21", "3h", "2%", 2),
    supple.TrainingRequest("IH21", 10_800, 0.02, 2),
    supple.StructureRequest("IH21", [0.1, 0.5], 0.4, 0.5, 0.1, "tile"),
    supple.StructureFileRequest("IH21", None, "stl", (1, 3), 5.0),
    *(supple.SimulationRequest("IH21", [0.1], load, {"law": "neo_hookean"}, 0.5, 0.1, "cell", 0.1, 1e-6, 0.1, 9, "on", "off", "on",
                               "off", False, "vtu") for load in LOADS),
    supple.EvaluationRequest("ih21", [0.15, 0.65], [0.1, 0, 0.05], 2),
    supple.UniaxialRequest("ih21", [0.15, 0.65], 0.5, [1.1], None, 1e-6, 9),
    supple.DesignRequest(TARGET, "heel", "IH21", None, [TARGET], [0.15, 0.65], [None, 0.65], (0, 1), 0.5,
                         [supple.Material((20, 60), 1.2, "TPU", 0.48, "neo_hookean"), supple.Material(5)], 0.4, None,
                         supple.Limits((0, 0.3), (2, 4), None), True,
                         supple.DesignOptions(1e-7, 1e-11, 9, 3, 32, 4, "on", "off", "on", 0.01, 7, 50, "off"), "s", 7.0),
    supple.RegionsRequest([supple.Region(TARGET)] * 2),
    supple.ProfileRequest("stress_strain", [0.1], None, "ih29", 0.5, None, "green", None, (0, 0.1), 3, 1e-9, 0.2,
                          supple.Material(5.0)),
    supple.MeasuredCurveRequest("strain,stress\n0,0\n", columns=(0, "stress"), units=(None, "kPa"), gauge_length=50, area=20,
                                limits=(0, 0.1), interpolation="linear", max_control_points=6, tolerance=0.01, origin="on",
                                loading="off", rupture="on", sense="tension", decimal_separator="comma", zero="first", block=1),
    supple.MeasuredCurveRequest(None, [[0, 0], [1, 1]]),
    supple.DrawingRequest("<svg/>", 50.0, "mm", 0.1, None, 72.0),
    supple.PartRequest(supple.parts.coupon(20, 60), "IH21", [0.1], supple.PartOptions(
        0.4, 0.1, 0.2, [supple.PartRegion([[0, 0], [1, 0], [0, 1]], "IH21", [0.1], 0.4, 0.1, "heel", 0.2)], 1.0, 0.5, "whole", 0.2, 2.0, 1.2, 0.3)),
    supple.PartRequest(supple.parts.regions_only(), "IH21", options=supple.PartOptions(regions=[supple.PartRegion([[0, 0], [1, 0], [0, 1]], "IH21")])),
    supple.PartFileRequest(supple.parts.polygons([[[0, 0], [1, 0], [0, 1]]]), "IH21", kind="3mf"),
    supple.PartSimulationRequest(
        supple.PartRequest(supple.parts.rectangle(20, 30), "IH21", [0.1], supple.PartOptions(0.4, density=1.1), deadline=9),
        [supple.Plate("top", (0, -1), 0.5, "stick"), supple.Clamp([[0, 0], [20, 1]])], None, {"youngs_modulus": "20 MPa"}, 5, 1.0, 0.5, 1e-6,
        9, 0.1, 2.0, "off", "on", "off", "vtu", True),
    supple.PartSimulationRequest(supple.PartRequest(supple.parts.block(20, 30), "IH21"), strain=-0.1),
    supple.PartSimulationFileRequest(supple.PartRequest(supple.parts.coupon(20, 30), "IH21"), kind="svg"),
    supple.WeaveLayoutRequest(supple.Weave.layout(STRANDS, lattice=[[8, 0], [0, 8]])),
    supple.WeavePictureRequest(supple.Weave.circles(2, circle_radius=6)),
    supple.WeaveHomogenizationRequest(supple.Weave.squares(2), 0.2, [0, 1], "suppressed", 0.5, [1], supple.WeaveOptions(
        8, 1e-8, 9, 2, 0.2, 0.05, 1e-5, "off", "on", 1e-4, "on")),
    supple.WeaveDeformationRequest(supple.Weave.rings(), np.eye(2), [0]),
    supple.WeaveSimulationRequest(WEAVE, [supple.Support(supple.Place.box((0, 1), (2, 3)), (1, 2, 3), (True, False, True), True,
                                                         (0, 0, 0.5))],
                                  [supple.Force(supple.Place.strand(2, share=0.5), (0, -1, 0))], 4, "vtu"),
    supple.WeaveToolpathRequest(WEAVE, supple.PrintOptions((1, 2), [1, 0], (3, 4), {1: (5, 6)}, 0.5, (2, 16),
                                                           [supple.Grip((0, 1), (2, 3), 4)], 0.01), {"bed": [9, 9, 9]}, ("svg",)),
    supple.GcodeReportRequest(b"G28\n", {"cold": 170}),
]


def test_requests_are_valid_with_all_that_may_be_given() -> None:
    assert {type(sample) for sample in SAMPLES} == set(REQUESTS)
    resolver = RefResolver("", CONTRACT)
    for sample in SAMPLES:
        body = CONTRACT["paths"][sample.path]["post"]["requestBody"]["content"]["application/json"]["schema"]
        faults = [f"{type(sample).__name__}: {fault.json_path}: {fault.message[:200]}"
                  for fault in Draft202012Validator(body, resolver=resolver).iter_errors(sample.to_wire())]
        assert not faults, faults
