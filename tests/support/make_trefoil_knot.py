#!/usr/bin/python3
"""Writes the project's sample mesh as OBJ: a closed tube around a trefoil knot.

    tests/support/make_trefoil_knot.py > api/examples/meshes/trefoil-knot.obj
"""

import math
import sys

ALONG = 160  # rings along the knot
ACROSS = 12  # vertices of a ring
RADIUS = 0.38  # radius of the tube; the strands of the knot are at least 1.2 apart, so that it does not meet itself


def normalized(v):
    length = math.sqrt(sum(c * c for c in v))
    return tuple(c / length for c in v)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def ring(j):
    t = 2 * math.pi * j / ALONG
    centre = (math.sin(t) + 2 * math.sin(2 * t), math.cos(t) - 2 * math.cos(2 * t), -math.sin(3 * t))
    tangent = normalized(
        (math.cos(t) + 4 * math.cos(2 * t), -math.sin(t) + 4 * math.sin(2 * t), -3 * math.cos(3 * t))
    )
    # The knot is nowhere vertical, so that the component of z normal to it gives a continuous frame.
    up = normalized(tuple((k == 2) - tangent[2] * tangent[k] for k in range(3)))
    side = cross(tangent, up)
    for i in range(ACROSS):
        v = -2 * math.pi * i / ACROSS
        yield tuple(centre[k] + RADIUS * (math.cos(v) * side[k] + math.sin(v) * up[k]) for k in range(3))


def main():
    out = sys.stdout
    out.write("# Trefoil knot, made by tests/support/make_trefoil_knot.py\n")
    for j in range(ALONG):
        for x, y, z in ring(j):
            out.write(f"v {x:.6f} {y:.6f} {z:.6f}\n")
    for j in range(ALONG):
        for i in range(ACROSS):
            a, b = j * ACROSS + i, j * ACROSS + (i + 1) % ACROSS
            c, d = (b + ACROSS) % (ALONG * ACROSS), (a + ACROSS) % (ALONG * ACROSS)
            out.write(f"f {a + 1} {b + 1} {c + 1}\nf {a + 1} {c + 1} {d + 1}\n")


if __name__ == "__main__":
    main()
