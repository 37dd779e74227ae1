"""Drawings compared with other programs: random SVG files with the picture of librsvg, and random DXF files written by ezdxf."""

from __future__ import annotations

import io
import math
import random
import shutil
import subprocess
import zlib
from typing import Any, Dict, List, Tuple

import numpy as np
import pytest

from harness import Api, problem_code

OUTLINES = "/v1/outlines"
SIDE = 60  # side of the page, mm
PIXELS = 600  # side of its picture
RSVG = shutil.which("rsvg-convert")


def grey_of_png(png: bytes) -> Any:
    """The alpha channel of an RGBA picture with 8 bits, shape (height, width), from 0 to 1."""
    at, data, size = 8, b"", (0, 0)
    while at < len(png):
        length = int.from_bytes(png[at:at + 4], "big")
        kind, content = png[at + 4:at + 8], png[at + 8:at + 8 + length]
        if kind == b"IHDR":
            size = (int.from_bytes(content[:4], "big"), int.from_bytes(content[4:8], "big"))
            assert content[8:10] == b"\x08\x06", "RGBA of 8 bits"
        elif kind == b"IDAT":
            data += content
        at += 12 + length
    width, height = size
    rows = np.frombuffer(zlib.decompress(data), dtype=np.uint8).reshape(height, 1 + 4 * width)
    picture = np.zeros((height + 1, 4 * width + 4), dtype=np.int64)
    for y in range(height):  # undoes PNG's filters
        kind, raw = rows[y, 0], rows[y, 1:].astype(np.int64)
        above, line = picture[y], picture[y + 1]
        if kind == 0:
            line[4:] = raw
        elif kind == 2:
            line[4:] = (raw + above[4:]) & 255
        else:
            for x in range(4, 4 + 4 * width):
                a, b, c = int(line[x - 4]), int(above[x]), int(above[x - 4])
                near = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
                line[x] = (raw[x - 4] + {1: a, 3: (a + b) // 2, 4: near}[int(kind)]) & 255
    return picture[1:, 4:].reshape(height, width, 4)[:, :, 3] / 255


def drawn_by_librsvg(text: str) -> Any:
    made = subprocess.run([str(RSVG), "-w", str(PIXELS), "-h", str(PIXELS)], input=text.encode(), capture_output=True, timeout=60, check=True)
    return grey_of_png(made.stdout)


def filled(polygons: List[Dict[str, Any]]) -> Any:
    """Pixels whose centre is within an odd number of the polygons, with the first row at the top."""
    inside = np.zeros((PIXELS, PIXELS), dtype=bool)
    middles = (np.arange(PIXELS) + 0.5) * SIDE / PIXELS
    for polygon in polygons:
        points = np.asarray(polygon["points"])
        for (x0, y0), (x1, y1) in zip(points, np.roll(points, -1, axis=0)):
            rows = np.nonzero((middles > min(y0, y1)) & (middles <= max(y0, y1)))[0]
            for row in rows:
                x = x0 + (middles[row] - y0) / (y1 - y0) * (x1 - x0)
                inside[PIXELS - 1 - row] ^= middles > x
    return inside


def shape(dice: random.Random) -> str:
    """A random shape in a cell of 18 mm around the origin."""
    radius = lambda: round(dice.uniform(2, 8), 2)  # noqa: E731
    ring = [(radius() * math.cos(t), radius() * math.sin(t)) for t in np.arange(dice.randint(3, 9)) * 0.7]
    points = " ".join(f"{x:.3f},{y:.3f}" for x, y in ring)
    a, b, c = radius(), radius(), radius()
    return dice.choice([
        f'<rect x="-{a}" y="-{b}" width="{2 * a}" height="{b + c}" rx="{dice.choice([0, 1, 99])}"',
        f'<circle r="{a}"', f'<ellipse rx="{a}" ry="{b}"', f'<polygon points="{points}"', f'<polyline points="{points}"',
        f'<path d="M-{a}-{b}h{2 * a}v{b + c}z m{a / 2} {b / 2}h{a / 2}v{b / 2}h-{a / 2}z"',
        f'<path d="M-{a},0A{a} {b} {dice.randint(0, 90)} {dice.choice(["01", "1 1", "0,0", "10"])}{c} 1 z"',
        f'<path d="M0-{a}C{a}-{b} {b},{c} 0 {c}s-{a},{b}-{c}-{b}q0-{a} {b} -{b}t{a / 2} 1"',
        f'<path d="M{points} L 0 0 Z"',
    ])


def paint(dice: random.Random) -> str:
    return dice.choice([
        "", "", 'fill="teal"', 'style="fill: #123"', 'class="shown"', 'class="evenodd"', 'fill-rule="evenodd"', 'style="fill-rule:evenodd;opacity:.5"',
        'display="none"', 'visibility="hidden"', 'class="gone"', 'class="unpainted"', 'style="fill:none"', 'fill="none"', 'opacity="0"',
        'class="gone shown" style="display:inline"', 'clip-path="url(#half)"', 'style="clip-path:url(#half)"',
    ])


def turned(dice: random.Random) -> str:
    return dice.choice(["", "rotate(30)", "scale(.8,-.6)", "skewX(20)", "matrix(.7 .2 -.3 .8 1 -1)", "rotate(45 1 1) scale(.7)", "translate(1,-1)rotate(-10)"])


def drawing_of(dice: random.Random) -> str:
    """A random drawing of nine cells, in each of which at most one shape is visible, so that no two shapes meet."""
    cells = []
    for k in range(9):
        x, y = 10 + 20 * (k % 3), 10 + 20 * (k // 3)
        one = f'{shape(dice)} {paint(dice)} transform="{turned(dice)}"/>'
        inner = dice.choice([one, one, f'<g {dice.choice(["fill=" + chr(34) + "red" + chr(34), "class=" + chr(34) + "dim" + chr(34), ""])}>{one}</g>',
                             f'<a>{one}</a>', f'<switch><foreignObject requiredExtensions="x"/>{one}<circle r="9"/></switch>',
                             f'<defs><g id="d{k}">{one}</g></defs><use xlink:href="#d{k}"/>',
                             f'<svg x="-9" y="-9" width="18" height="18" viewBox="-6 -9 12 18">{one}</svg>'])
        cells.append(f'<g transform="translate({x} {y}) scale(.9)">{inner}</g>')
    style = ("<style>/* .shown{display:none} */ .gone{display:none} .unpainted{fill:none} .evenodd{fill-rule:evenodd}"
             " g.dim{opacity:.4} .nobody, g > .nowhere{fill:none} @media print{path{display:none}}</style>")
    clip = '<clipPath id="half"><rect x="-20" y="-20" width="22" height="40"/><circle cx="4" r="2"/></clipPath>'
    return (f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="{SIDE}mm" height="{SIDE}mm" viewBox="0 0 {SIDE} {SIDE}">'
            f'{style}<defs>{clip}</defs>{"".join(cells)}</svg>')


@pytest.mark.skipif(RSVG is None, reason="rsvg-convert (librsvg2-bin) is not installed")
@pytest.mark.parametrize("seed", range(40))
def test_random_drawings_fill_what_librsvg_fills(api: Api, seed: int) -> None:
    text = drawing_of(random.Random(seed))
    picture = drawn_by_librsvg(text)
    response = api.post(OUTLINES, {"text": text, "accuracy": {"tolerance": 0.005}})
    if picture.max() == 0:
        assert problem_code(response) == "outline.nothing_closed"
        return
    assert response.status_code == 200, response.text
    ours = filled(response.json()["polygons"])
    # Only pixels that are clearly solid or empty are compared, since opacities differ and edges are antialiased.
    sure = np.zeros_like(ours)
    solid, empty = picture > 0.3, picture < 0.02
    for shift in ((0, 1), (1, 0), (0, -1), (-1, 0)):
        solid &= np.roll(picture, shift, (0, 1)) > 0.3
        empty &= np.roll(picture, shift, (0, 1)) < 0.02
    sure = solid | empty
    wrong = int((ours[sure] != solid[sure]).sum())
    # A few pixels at thin tips differ because of rounding in librsvg; the smallest shape has some hundreds.
    assert wrong <= 20, f"seed {seed}: {wrong} of {int(sure.sum())} pixels differ in\n{text}"
    # The answer lists everything that is not visible.
    answer = response.json()
    assert answer["left_out_count"] == len(answer["left_out"]) and all(one["reason"] for one in answer["left_out"])


VERSIONS = ["R12", "R2000", "R2004", "R2007", "R2010", "R2013", "R2018"]
UNITS = {1: 25.4, 4: 1.0, 5: 10.0, 6: 1000.0}


def dxf_of(dice: random.Random, version: str) -> Tuple[str, float, float]:
    """A random file by ezdxf, the area in mm^2 within its closed curves, and the tolerance of that area."""
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new(version)
    unit = dice.choice(sorted(UNITS))
    if version != "R12":
        document.header["$INSUNITS"] = unit
    scale = UNITS[unit] if version != "R12" else 1.0
    unit_length = 20 / scale  # 20 mm in units of the drawing
    space = document.modelspace()
    for name in ("cut", "Außen", "off"):
        document.layers.new(name)
    document.layers.get("off").off()
    area = 0.0
    for k in range(6):
        x, y, a = 2 * k * unit_length, 0.0, unit_length * dice.uniform(0.3, 0.9)
        kind = dice.choice(["circle", "lines", "polyline", "arcs", "block", "fine"])
        layer = {"layer": dice.choice(["cut", "Außen"])}
        if kind == "circle":
            space.add_circle((x, y), a / 2, dxfattribs=layer)
            area += math.pi * a * a / 4
        elif kind in ("lines", "fine"):
            count = 4 if kind == "lines" else dice.choice([60, 700])
            corners = [(x + a / 2 * math.cos(2 * math.pi * i / count), y + a / 2 * math.sin(2 * math.pi * i / count)) for i in range(count)]
            pieces = list(zip(corners, corners[1:] + corners[:1]))
            pieces += dice.sample(pieces, dice.choice([0, 1, count]))  # duplicates of lines
            dice.shuffle(pieces)
            layers = dice.choice([["cut"], ["cut", "Außen"]]) if kind == "lines" else ["cut"]
            for p, q in pieces:
                p, q = (p, q) if dice.random() < 0.5 else (q, p)
                space.add_line(p, q, dxfattribs={"layer": layers[0 if p[0] + q[0] < 2 * x else -1]})
            if dice.random() < 0.5:  # a stray line at a corner
                space.add_line(corners[0], (corners[0][0] + a / 3, corners[0][1] + a / 5), dxfattribs={"layer": "cut"})
            area += count * math.sin(2 * math.pi / count) / 2 * a * a / 4
        elif kind == "polyline":
            points = [(x, y), (x + a, y), (x + a, y + a / 2), (x, y + a / 2)]
            (space.add_polyline2d if version == "R12" else space.add_lwpolyline)(points, dxfattribs=layer).close(True)
            area += a * a / 2
        elif kind == "arcs":
            space.add_arc((x, y), a / 2, 0, 180, dxfattribs=layer)
            space.add_arc((x, y), a / 2, 180, 360, dxfattribs=layer)
            area += math.pi * a * a / 4
        else:
            block = document.blocks.new(f"block{k}")
            block.add_circle((0, 0), a / 4)
            space.add_blockref(f"block{k}", (x, y), dxfattribs={**layer, "xscale": 2, "yscale": -2, "rotation": 30})
            area += math.pi * a * a / 4
    space.add_circle((0, 0), 9 * unit_length, dxfattribs={"layer": "off"})
    if version != "R12":
        document.layout("Layout1").add_circle((0, 0), 7 * unit_length)
    out = io.StringIO()
    document.write(out)
    return out.getvalue(), area * scale * scale, 6 * math.pi * 20 * 0.01


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("seed", range(4))
def test_dxf_files_of_every_version_enclose_their_area(api: Api, version: str, seed: int) -> None:
    text, area, slack = dxf_of(random.Random(f"{version} {seed}"), version)
    answer = api.ok(OUTLINES, {"text": text, "accuracy": {"tolerance": 0.01}})
    assert answer["unit_is_known"] == (version != "R12")
    found = 0.0
    for polygon in answer["polygons"]:
        x, y = np.asarray(polygon["points"]).T
        found += abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2
    assert found == pytest.approx(area, abs=slack + 0.01 * area), f"{version}, seed {seed}"
    assert len(answer["polygons"]) == 6
    reasons = [one["reason"] for one in answer["left_out"]]
    assert any("layer is off" in reason for reason in reasons)
    assert version == "R12" or any("paper space" in reason for reason in reasons)
