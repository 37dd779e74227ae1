#!/usr/bin/python3
"""Draws the README's picture from the answers of a running server.

    PYTHONPATH=clients/python docs/images/render.py MESH_FILE docs/images/first_screen.png

Left: the exact geodesic distance from one point, with its level lines. Right: the Karcher mean of five points, and the
geodesics that join them to it.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Tuple

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.colors import LinearSegmentedColormap  # noqa: E402

import supple  # noqa: E402

PIXELS = 900
MARGIN = 20
LEVELS = 24
LIGHT = np.array([0.35, 0.45, 0.82])
BACKGROUND = np.array([1.0, 1.0, 1.0])
PLAIN = np.array([0.82, 0.85, 0.90])
COLOURS = LinearSegmentedColormap.from_list(
    "distance", ["#20124d", "#2c3e88", "#206e8e", "#269c80", "#78c852", "#f5e43c"])


@dataclass
class View:
    """A mesh seen from far away: pixel coordinates of each vertex and its depth, larger being nearer."""

    xy: np.ndarray
    depth: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    rotation: np.ndarray
    centre: np.ndarray
    scale: float

    def project(self, positions: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        turned = (positions - self.centre) @ self.rotation.T
        return turned[:, :2] * self.scale + PIXELS / 2, turned[:, 2]


def look_at(vertices: np.ndarray, faces: np.ndarray, azimuth: float, elevation: float) -> View:
    a, e = np.radians(azimuth), np.radians(elevation)
    forward = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0])
    rotation = np.stack([right, np.cross(forward, right), forward])
    corners = vertices[faces]
    normals = np.zeros_like(vertices)
    face_normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    for corner in range(3):
        np.add.at(normals, faces[:, corner], face_normals)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    turned = vertices @ rotation.T
    middle = (turned.max(axis=0) + turned.min(axis=0)) / 2
    scale = 0.94 * PIXELS / (turned.max(axis=0) - turned.min(axis=0))[:2].max()
    view = View(np.empty((0, 2)), np.empty(0), normals @ rotation.T, faces, rotation, middle @ rotation, scale)
    view.xy, view.depth = view.project(vertices)
    return view


def rasterize(view: View) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Per pixel: the visible face (-1 for none), its barycentric coordinates and the depth."""
    shown = np.full((PIXELS, PIXELS), -1, dtype=int)
    weights = np.zeros((PIXELS, PIXELS, 3))
    nearest = np.full((PIXELS, PIXELS), -np.inf)
    for index, face in enumerate(view.faces):
        (x0, y0), (x1, y1), (x2, y2) = corners = view.xy[face]
        area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        if area <= 1e-9:
            continue
        low = np.maximum(np.floor(corners.min(axis=0)).astype(int), 0)
        high = np.minimum(np.ceil(corners.max(axis=0)).astype(int) + 1, PIXELS)
        px, py = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
        b1 = ((px - x0) * (y2 - y0) - (x2 - x0) * (py - y0)) / area
        b2 = ((x1 - x0) * (py - y0) - (px - x0) * (y1 - y0)) / area
        b = np.stack([1 - b1 - b2, b1, b2], axis=-1)
        depth = b @ view.depth[face]
        window = (slice(low[1], high[1]), slice(low[0], high[0]))
        wins = (b >= -1e-9).all(axis=-1) & (depth > nearest[window])
        shown[window][wins] = index
        weights[window][wins] = b[wins]
        nearest[window][wins] = depth[wins]
    return shown, weights, nearest


def shade(view: View, shown: np.ndarray, weights: np.ndarray, base: np.ndarray) -> np.ndarray:
    """Diffuse light on the base colours, shape (PIXELS, PIXELS, 3)."""
    normals = (weights[..., None] * view.normals[view.faces[shown]]).sum(axis=2)
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-9)
    light = 0.45 + 0.6 * np.clip(normals @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1)
    image = np.clip(base * light[..., None], 0, 1)
    image[shown < 0] = BACKGROUND
    return image


def field_colours(view: View, shown: np.ndarray, weights: np.ndarray, distances: np.ndarray) -> np.ndarray:
    value = (weights * distances[view.faces[shown]]).sum(axis=-1) / distances.max()
    base = COLOURS(value)[..., :3]
    # A level line is where the level changes within a pixel.
    slope = np.hypot(*np.gradient(value * LEVELS))
    phase = np.abs(value * LEVELS - np.round(value * LEVELS))
    line = np.clip(1.6 - phase / np.maximum(slope, 1e-6), 0, 1) * (np.round(value * LEVELS) > 0) * (slope < 0.5)
    return base * (1 - 0.65 * line[..., None])


def draw_points(axes: "plt.Axes", view: View, nearest: np.ndarray, positions: np.ndarray, **style: object) -> None:
    xy, depth = view.project(positions)
    pixel = np.clip(np.round(xy).astype(int), 0, PIXELS - 1)
    visible = depth > nearest[pixel[:, 1], pixel[:, 0]] - 0.02 * np.ptp(view.depth)
    axes.scatter(xy[visible, 0], xy[visible, 1], **style)


def draw_path(axes: "plt.Axes", view: View, nearest: np.ndarray, positions: np.ndarray) -> None:
    segments = [np.linspace(a, b, 12) for a, b in zip(positions, positions[1:])]
    xy, depth = view.project(np.concatenate(segments))
    pixel = np.clip(np.round(xy).astype(int), 0, PIXELS - 1)
    hidden = depth < nearest[pixel[:, 1], pixel[:, 0]] - 0.02 * np.ptp(view.depth)
    xy[hidden] = np.nan
    axes.plot(xy[:, 0], xy[:, 1], color="#b3202c", linewidth=2.2, solid_capstyle="round")


def main() -> int:
    source_file, target_file = sys.argv[1:3]
    with supple.Client() as client:
        mesh = client.upload(source_file)
        vertices, faces = mesh.arrays()
        view = look_at(vertices, faces, azimuth=40, elevation=42)
        shown, weights, nearest = rasterize(view)
        visible = np.unique(shown[shown >= 0])
        stream = np.random.default_rng(11)
        third = (1 / 3, 1 / 3, 1 - 2 / 3)
        source = (int(visible[np.argmax(view.depth[faces[visible]].mean(axis=1))]), third)
        chosen = [(int(f), third) for f in stream.choice(visible, size=5, replace=False)]
        field = mesh.field([source])
        mean = mesh.karcher_mean(chosen)
        paths = [g.path.positions for g in mesh.geodesics([(p, mean.mean) for p in chosen], paths=True) if g.path]

    rows = np.flatnonzero((shown >= 0).any(axis=1))
    bottom, top = rows[0] - MARGIN, rows[-1] + MARGIN
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 0.45 + 6 * (top - bottom) / PIXELS), dpi=100)
    left.imshow(shade(view, shown, weights, field_colours(view, shown, weights, field.distances)), origin="lower")
    source_position = np.array([third @ vertices[faces[source[0]]]])
    draw_points(left, view, nearest, source_position, s=70, color="white", edgecolors="black", zorder=3)
    left.set_title(f"Exact distance to {mesh.info.vertices:,} vertices: {1e3 * field.seconds:.0f} ms", fontsize=12)

    right.imshow(shade(view, shown, weights, np.broadcast_to(PLAIN, (*shown.shape, 3))), origin="lower")
    for path in paths:
        draw_path(right, view, nearest, path)
    ends = np.array([third @ vertices[faces[face]] for face, _ in chosen])
    draw_points(right, view, nearest, ends, s=55, color="#2c3e88", edgecolors="white", zorder=3)
    draw_points(right, view, nearest, np.array([mean.position]), s=190, color="#f5c518", edgecolors="black", marker="*", zorder=4)
    right.set_title(f"Karcher mean of five points: {mean.iterations} Newton steps, |gradient| = {mean.gradient_norm:.0e}", fontsize=12)
    for axes in (left, right):
        axes.set_axis_off()
        axes.set_ylim(bottom, top)
    figure.subplots_adjust(left=0, right=1, top=1 - 0.45 / figure.get_figheight(), bottom=0, wspace=0)
    figure.savefig(target_file)
    return 0


if __name__ == "__main__":
    sys.exit(main())
