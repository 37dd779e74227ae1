"""Parts to print or cut: the suite's own code reads their files, compares them with its own drawings of the tilings, and erodes and measures them with GEOS."""

from __future__ import annotations

from typing import Any, Dict, Iterator, Tuple

import numpy as np
from shapely.affinity import translate
from shapely.geometry import MultiPolygon, Point, Polygon, box
from shapely.ops import unary_union

import _solids
from _drawings import differing, holes, placed
from _tilings import FAMILIES, draws, structure_of
from truth import Check, Refusal, Server

ABOUT = ("Random coupons, blocks, rectangles and polygons, filled with random tilings in random orientations. Files are read again by the suite's own code; GEOS says where "
         "a part is parted that is eroded by half of the wall, and by a little less and more than half of its narrowest neck; and an own drawing of the tiling, turned as the "
         "documents say, is laid over the part.")

CORNER = 0.25 * np.sqrt(2) + 0.49 * (np.sqrt(2) - 1)
"""Distance, in widths of the smallest wall, up to which corners may be rounded. A disk is approximated by a polygon of few sides, so that it can reach corners
that are farther away by the square root of two."""

CHECKS = {
    "area": Check("`solid_area` beside that of the DXF file", 1e-5, "mm, over the perimeter"),
    "same drawing": Check("area between the SVG and the DXF file", 2e-5, "mm, over the perimeter"),
    "same solid": Check("volume of the STL and 3MF file over the thickness, beside the area of the DXF file", 2e-5, "mm, over the perimeter"),
    "closed": Check("edges of the STL and 3MF file that two triangles do not share", 0, "count"),
    "valid": Check("files whose outlines cross or touch themselves", 0, "1 if they do"),
    "bookkeeping": Check("size, corners, holes, density, volume and mass, computed from the DXF file", 1e-5, "mm, or of it"),
    "tested direction": Check("`orientation` and `tested_direction`, beside the rule", 1e-12, "rad"),
    "refused direction": Check("directions that an outline without an axis of load takes", 0, "1 if it does"),
    "whole at the wall": Check("places that eroding by half of .98 walls parts, but for pieces smaller than a hundredth of a wall", 0, "count"),
    "whole at the neck": Check("places that eroding by half of `smallest_neck` less 1 % parts", 0, "count"),
    "parted at the neck": Check("parts with holes of which eroding by half of `smallest_neck` and 1 % more parts no place", 0, "1 if none"),
    "no neck": Check("places that eroding by half a wall to a wall parts, of parts that have no narrow place", 0, "count"),
    "narrow walls": Check("how far corners go beyond what a disk of the wall's width reaches", CORNER, "of the wall"),
    "drawing": Check("area between the part and an own drawing of the tiling, less what `checks` says was left out or added", 2e-3, "of the outline's area"),
}


def case(rng: np.random.Generator) -> Dict[str, Any]:
    kind = str(rng.choice(["coupon", "block", "rectangle", "polygons"], p=[0.4, 0.2, 0.2, 0.2]))
    width, height = (float(size) for size in rng.uniform(8, 40, size=2))
    beam = float(rng.uniform(0.3, 0.9))
    turn = float(rng.uniform(-np.pi, np.pi))
    angles = np.sort(rng.uniform(0, 2 * np.pi, size=int(rng.integers(4, 9)))) + np.arange(1) * 0.1
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1) * rng.uniform(8, 20, size=(len(angles), 1))
    outline: Dict[str, Any] = {
        "coupon": {"coupon": {"width": width, "length": height, "grip_length": float(rng.uniform(1, 8))}},
        "block": {"block": {"width": width, "height": height, "plate": float(rng.uniform(0.5, 3))}},
        "rectangle": {"rectangle": [width, height]},
        "polygons": {"polygons": [ring.tolist()]}}[kind]
    return {"kind": kind, "outline": outline, "family": str(rng.choice(FAMILIES)), "shares": draws(rng), "beam_width": beam,
            "orientation": turn if rng.uniform() < 0.8 else 0.0, "direction": float(rng.uniform(-np.pi, np.pi)) if rng.uniform() < 0.4 else None,
            "frame": float(rng.uniform(0.5, 2)) if rng.uniform() < 0.2 and kind != "polygons" else 0.0,
            "smallest_wall": float(beam * rng.uniform(0.3, 1)) if rng.uniform() < 0.4 else None,
            "thickness": float(rng.uniform(0.5, 5)), "density": float(rng.uniform(0.8, 3)), "solid": str(rng.choice(["stl", "3mf"]))}


def examine(server: Server, drawn: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    structure = structure_of(server, drawn["family"], drawn["shares"], drawn["beam_width"])
    if structure is None:
        return
    body = {"outline": drawn["outline"], "structure": {"family": drawn["family"], "parameters": structure["parameters"]}, "beam_width": drawn["beam_width"],
            "orientation": drawn["orientation"], "frame": drawn["frame"], "thickness": drawn["thickness"], "material": {"density": drawn["density"]}}
    if drawn["smallest_wall"] is not None:
        body["smallest_wall"] = drawn["smallest_wall"]
    if drawn["direction"] is not None:
        if drawn["kind"] in ("rectangle", "polygons"):
            yield "refused direction", float(_taken(server, {**body, "direction": drawn["direction"]}))
        else:
            body["direction"] = drawn["direction"]
    try:
        answer = server.post("/v1/parts", {**body, "svg": True})
    except Refusal as refusal:
        if refusal.code != "tiling.part":  # Outlines between the beams of large tiles are empty, or polygons cross themselves.
            raise
        return
    part = _solids.of_rings(_solids.dxf_rings(server.file("/v1/parts", body, "image/vnd.dxf").decode()))
    yield "valid", float(not part.is_valid)
    yield from _files(server, body, drawn, answer, part)
    yield from _booked(drawn, answer, part)
    yield from _necks(answer["checks"], part)
    yield "drawing", _drawn_apart(drawn, structure, answer, part)


def _taken(server: Server, body: Dict[str, Any]) -> bool:
    try:
        server.post("/v1/parts", body)
    except Refusal as refusal:
        return (refusal.status, refusal.code) != (400, "request.invalid")
    return True


def _files(server: Server, body: Dict[str, Any], drawn: Dict[str, Any], answer: Dict[str, Any], part: Any) -> Iterator[Tuple[str, float]]:
    yield "area", (answer["solid_area"] - part.area) / part.length
    picture = _solids.of_rings(_solids.svg_rings(answer["svg"]))
    middle = (np.array(answer["lower"]) + answer["upper"]) / 2
    picture = translate(picture, *middle)
    yield "valid", float(not picture.is_valid)
    yield "same drawing", picture.symmetric_difference(part).area / part.length if picture.is_valid and part.is_valid else np.nan
    if drawn["solid"] == "stl":
        triangles = _solids.stl_triangles(server.file("/v1/parts", body, "model/stl"))
    else:
        triangles = _solids.package_triangles(server.file("/v1/parts", body, "model/3mf"))
    yield "closed", _solids.open_edges(triangles)
    yield "same solid", (_solids.volume(triangles) / drawn["thickness"] - part.area) / part.length


def _booked(drawn: Dict[str, Any], answer: Dict[str, Any], part: Any) -> Iterator[Tuple[str, float]]:
    low, high = np.array(part.bounds[:2]), np.array(part.bounds[2:])
    yield "bookkeeping", np.max(np.abs(np.array(answer["lower"]) - low))
    yield "bookkeeping", np.max(np.abs(np.array(answer["upper"]) - high))
    yield "bookkeeping", np.max(np.abs(np.array(answer["size"]) - np.array([*(high - low), drawn["thickness"]])))
    yield "bookkeeping", answer["holes"] - len(part.interiors)
    yield "bookkeeping", answer["outline_area"] / _outline(drawn).area - 1
    yield "bookkeeping", answer["relative_density"] * answer["outline_area"] / answer["solid_area"] - 1
    yield "bookkeeping", answer["volume"] / (answer["solid_area"] * drawn["thickness"]) - 1
    yield "bookkeeping", answer["mass"] / (answer["volume"] * drawn["density"] / 1000) - 1
    loaded = drawn["kind"] in ("coupon", "block")
    turn = np.pi / 2 - drawn["direction"] if loaded and drawn["direction"] is not None else 0.0
    yield "tested direction", answer["orientation"] - drawn["orientation"] - turn
    if loaded:
        yield "tested direction", answer["tested_direction"] - (drawn["direction"] if drawn["direction"] is not None else np.pi / 2)
    else:
        yield "tested direction", float(answer["tested_direction"] is not None)


def _topology(part: Any, radius: float, least: float) -> int:
    """Number of pieces minus number of holes after eroding, for pieces of more than the least area. It increases by one if erosion cuts a neck, whether the part then
    falls into two pieces or two holes become one. Corners and dead ends that vanish do not change it."""
    eroded = part.buffer(-radius, resolution=16)
    return sum(1 - len(piece.interiors) for piece in (eroded.geoms if isinstance(eroded, MultiPolygon) else [eroded]) if piece.area > least)


def _necks(checks: Dict[str, Any], part: Any) -> Iterator[Tuple[str, float]]:
    wall, neck = checks["smallest_wall"], checks["smallest_neck"]
    least = (0.01 * wall) ** 2
    whole = 1 - len(part.interiors)
    yield "whole at the wall", max(0, _topology(part, 0.49 * wall * 0.999, least) - whole)
    if neck is not None:
        yield "whole at the neck", max(0, _topology(part, neck / 2 * 0.99, least) - whole)
        # A part without holes is a single junction with dead ends. Disks on either side of its neck may be hardly larger than the neck, and vanish with it.
        if part.interiors:
            yield "parted at the neck", float(_topology(part, neck / 2 * 1.01, 0.0) <= whole)
    else:
        yield "no neck", max(0, max(_topology(part, radius * wall, least) for radius in (0.5, 0.75, 1)) - whole)
    reached = part.buffer(-0.49 * wall, resolution=16).buffer(0.49 * wall, resolution=16)
    beyond = part.difference(reached.buffer(0.2 * wall, resolution=4))
    corners = [Point(corner) for piece in getattr(beyond, "geoms", [beyond]) if not piece.is_empty for corner in piece.exterior.coords]
    yield "narrow walls", max((reached.distance(corner) for corner in corners), default=0.0) / wall


def _outline(drawn: Dict[str, Any]) -> Any:
    outline = drawn["outline"]
    if "polygons" in outline:
        return Polygon(outline["polygons"][0])
    if "rectangle" in outline:
        return box(0, 0, *outline["rectangle"])
    if "coupon" in outline:
        coupon = outline["coupon"]
        return box(0, 0, coupon["width"], coupon["length"] + 2 * coupon["grip_length"])
    return box(0, 0, outline["block"]["width"], outline["block"]["height"] + 2 * outline["block"]["plate"])


def _drawn_apart(drawn: Dict[str, Any], structure: Dict[str, Any], answer: Dict[str, Any], part: Any) -> float:
    """Compares the part with the suite's own drawing, in which all except the holes of tiles is solid."""
    outline = _outline(drawn)
    turn = drawn["orientation"]
    if drawn["kind"] in ("coupon", "block") and drawn["direction"] is not None:
        turn += np.pi / 2 - drawn["direction"]
    low, high = np.array(outline.bounds[:2]), np.array(outline.bounds[2:])
    solid = outline.difference(placed(holes(structure), structure, outline, turn))
    solids = []
    if "coupon" in drawn["outline"]:
        grip = drawn["outline"]["coupon"]["grip_length"]
        solids = [box(low[0], low[1], high[0], low[1] + grip), box(low[0], high[1] - grip, high[0], high[1])]
    if "block" in drawn["outline"]:
        plate = drawn["outline"]["block"]["plate"]
        solids = [box(low[0], low[1], high[0], low[1] + plate), box(low[0], high[1] - plate, high[0], high[1])]
    if drawn["frame"]:
        solids.append(outline.difference(outline.buffer(-drawn["frame"], join_style=2)))
    solid = unary_union([solid, *solids])
    return differing(part, solid, answer["checks"], outline)
