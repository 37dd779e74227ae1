"""Exact geodesic distances by unfolding: the least length over all sequences of faces and over all vertices at which paths can bend.

Every source sends a bundle of rays across each edge of its face. The bundle is unfolded into the plane of the next face, whose opposite corner
divides it, and so on. A bundle ends only if it is longer than known paths to all targets, or if for all its rays the path along the edge from
one of its ends is shorter. Vertices at which paths can bend send bundles too, which begin with the distance of the vertex.
"""

from __future__ import annotations

from typing import List, Sequence, Tuple

import numpy as np

from _surface import ON_EDGE, Point, Surface

SLACK = 1e-11
"""Fraction of an edge by which a ray may miss an interval. The path is longer only by the square of this."""


class Bundles:
    """Arrays of bundles: rays from unfolded sources (x, y < 0) through the intervals [low, high] in the frames of halfedges. `before` is the length
    of the path up to the source."""

    def __init__(self, halfedge: np.ndarray, x: np.ndarray, y: np.ndarray, low: np.ndarray, high: np.ndarray, source: np.ndarray, before: np.ndarray) -> None:
        self.halfedge, self.x, self.y, self.low, self.high, self.source, self.before = halfedge, x, y, low, high, source, before

    def __len__(self) -> int:
        return len(self.halfedge)

    def only(self, chosen: np.ndarray) -> "Bundles":
        return Bundles(*(part[chosen] for part in self._parts()))

    def _parts(self) -> Tuple[np.ndarray, ...]:
        return self.halfedge, self.x, self.y, self.low, self.high, self.source, self.before

    @staticmethod
    def joined(all_of: "Sequence[Bundles]") -> "Bundles":
        return Bundles(*(np.concatenate(parts) for parts in zip(*(one._parts() for one in all_of))))


def distances(surface: Surface, sources: Sequence[Point], targets: Sequence[Point], to_vertices: bool = False) -> Tuple[np.ndarray, np.ndarray]:
    """Distances from each source to each target, and to each vertex. The latter are complete only with `to_vertices`."""
    return _Search(surface, sources, targets, to_vertices).run()


class _Search:
    def __init__(self, surface: Surface, sources: Sequence[Point], targets: Sequence[Point], to_vertices: bool) -> None:
        self.surface = surface
        self.to_vertices = to_vertices
        self.vertex_distance = np.full((len(sources), len(surface.vertices)), np.inf)
        self.target_distance = np.full((len(sources), len(targets)), np.inf)
        self.places, self.entry_target, self.entries_of = self._place(targets)
        self.start = self._begin(sources, targets)
        self.sent = np.full_like(self.vertex_distance, np.inf)

    def _place(self, targets: Sequence[Point]) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Targets in the frames of the halfedges of all faces that contain them, and for each face the list of these, padded with -1."""
        places: List[np.ndarray] = []
        owner: List[int] = []
        of_face: List[List[int]] = [[] for _ in self.surface.faces]
        for index, target in enumerate(targets):
            for face, coordinates in self.surface.entries(target):
                of_face[face].append(len(owner))
                owner.append(index)
                places.append(np.stack([self._in_frame(3 * face + i, coordinates) for i in range(3)]))
        widest = max((len(entries) for entries in of_face), default=0)
        table = np.full((len(of_face), max(widest, 1)), -1)
        for face, entries in enumerate(of_face):
            table[face, :len(entries)] = entries
        return (np.stack(places) if places else np.zeros((1, 3, 2))), np.array(owner or [0]), table

    def _in_frame(self, halfedge: int, coordinates: np.ndarray) -> np.ndarray:
        surface, first = self.surface, halfedge % 3
        along, apex = coordinates[(first + 1) % 3], coordinates[(first + 2) % 3]
        return np.array([along * surface.length[halfedge] + apex * surface.apex_x[halfedge], apex * surface.apex_y[halfedge]])

    def _begin(self, sources: Sequence[Point], targets: Sequence[Point]) -> Bundles:
        """The bundles of the sources, after setting all distances within the faces that contain them."""
        surface = self.surface
        found: List[Tuple[int, float, float, int, float]] = []
        of_face = [[] for _ in surface.faces]  # type: List[List[Tuple[int, np.ndarray]]]
        for index, target in enumerate(targets):
            for face, coordinates in surface.entries(target):
                of_face[face].append((index, coordinates @ surface.layout[face]))
        for source, point in enumerate(sources):
            for face, coordinates in surface.entries(point):
                place = coordinates @ surface.layout[face]
                for corner in range(3):
                    self._near(source, int(surface.faces[face, corner]), float(np.linalg.norm(place - surface.layout[face, corner])))
                for index, other in of_face[face]:
                    self.target_distance[source, index] = min(self.target_distance[source, index], float(np.linalg.norm(place - other)))
                for i in range(3):
                    halfedge = 3 * face + i
                    twin = int(surface.twin[halfedge])
                    if twin < 0 or coordinates[(i + 2) % 3] < ON_EDGE:
                        continue
                    x, y = self._in_frame(halfedge, coordinates)
                    found.append((twin, surface.length[halfedge] - x, -y, source, 0.0))
        return self._whole(found)

    def _near(self, source: int, vertex: int, distance: float) -> None:
        self.vertex_distance[source, vertex] = min(self.vertex_distance[source, vertex], distance)

    def _whole(self, found: List[Tuple[int, float, float, int, float]]) -> Bundles:
        """The bundles through whole edges."""
        halfedge = np.array([one[0] for one in found], dtype=int)
        x, y, before = (np.array([one[k] for one in found], dtype=float) for k in (1, 2, 4))
        source = np.array([one[3] for one in found], dtype=int)
        return Bundles(halfedge, x, y, np.zeros(len(found)), self.surface.length[halfedge], source, before)

    def run(self) -> Tuple[np.ndarray, np.ndarray]:
        bundles = self.start
        while len(bundles):
            self._along_edges()
            while len(bundles):
                bundles = self._step(bundles)
            self._along_edges()
            bundles = self._from_vertices()
        return self.target_distance, self.vertex_distance

    def _along_edges(self) -> None:
        """Updates distances of vertices, and of targets in the faces around them, with shorter paths along edges."""
        surface, table = self.surface, self.vertex_distance
        while True:
            before = table.copy()
            for a, b in ((surface.start, surface.end), (surface.end, surface.start)):
                np.minimum.at(table.T, b, table.T[a] + surface.length[:, None])
            if np.array_equal(before, table):
                break
        faces, columns = np.nonzero(self.entries_of >= 0)
        entries = self.entries_of[faces, columns]
        for i in range(3):
            way = np.linalg.norm(self.places[entries, i], axis=1)
            np.minimum.at(self.target_distance.T, self.entry_target[entries], table.T[surface.faces[faces, i]] + way[:, None])

    def _bound(self) -> np.ndarray:
        """For each source the longest known distance to its targets."""
        bound = self.target_distance.max(axis=1) if self.target_distance.shape[1] else np.zeros(len(self.target_distance))
        return np.maximum(bound, self.vertex_distance.max(axis=1)) if self.to_vertices else bound

    def _step(self, bundles: Bundles) -> Bundles:
        """Propagates bundles across the faces that they enter, and returns those that leave them."""
        surface, h = self.surface, bundles.halfedge
        x, y, low, high = bundles.x, bundles.y, bundles.low, bundles.high
        slack = SLACK * surface.length[h]
        # Whether rays of the bundle reach the opposite corner and the face's targets.
        apex_x, apex_y = surface.apex_x[h], surface.apex_y[h]
        divide = x + (apex_x - x) * -y / (apex_y - y)
        seen = (divide >= low - slack) & (divide <= high + slack)
        np.minimum.at(self.vertex_distance, (bundles.source[seen], surface.apex[h[seen]]),
                      bundles.before[seen] + np.hypot(apex_x - x, apex_y - y)[seen])
        entries = self.entries_of[h // 3]
        at = self.places[np.maximum(entries, 0), (h % 3)[:, None]]
        across = x[:, None] + (at[..., 0] - x[:, None]) * -y[:, None] / (at[..., 1] - y[:, None])
        row, column = np.nonzero((entries >= 0) & (across >= (low - slack)[:, None]) & (across <= (high + slack)[:, None]))
        np.minimum.at(self.target_distance, (bundles.source[row], self.entry_target[entries[row, column]]),
                      bundles.before[row] + np.hypot(at[row, column, 0] - x[row], at[row, column, 1] - y[row]))
        next_of, previous_of = h - h % 3 + (h + 1) % 3, h - h % 3 + (h + 2) % 3
        left = self._leave(bundles, surface.twin[previous_of], np.zeros_like(x), np.zeros_like(x), apex_x, apex_y, low, np.minimum(high, divide))
        right = self._leave(bundles, surface.twin[next_of], apex_x, apex_y, surface.length[h], np.zeros_like(x), np.maximum(low, divide), high)
        return self._useful(Bundles.joined([left, right]))

    @staticmethod
    def _leave(bundles: Bundles, twin: np.ndarray, from_x: np.ndarray, from_y: np.ndarray, to_x: np.ndarray, to_y: np.ndarray,
               low: np.ndarray, high: np.ndarray) -> Bundles:
        """The bundles in the frames of the halfedges through which they leave, which go from one given place to another. `low` and `high` are on the
        edges through which they enter."""
        keep = (twin >= 0) & (high > low)
        twin, from_x, from_y, to_x, to_y, low, high = (part[keep] for part in (twin, from_x, from_y, to_x, to_y, low, high))
        bundles = bundles.only(keep)
        length = np.hypot(to_x - from_x, to_y - from_y)
        ex, ey = (to_x - from_x) / length, (to_y - from_y) / length
        sx, sy = bundles.x - from_x, bundles.y - from_y

        def reach(through: np.ndarray) -> np.ndarray:
            dx, dy = through - bundles.x, -bundles.y
            # A ray along the edge itself has no intersection with it: its bundle begins or ends at the edge's tail.
            with np.errstate(divide="ignore", invalid="ignore"):
                return np.clip(np.nan_to_num((sx * dy - sy * dx) / (ex * dy - ey * dx), nan=0), 0, length)

        made = Bundles(twin, sx * ex + sy * ey, ex * sy - ey * sx, reach(low), reach(high), bundles.source, bundles.before)
        return made.only((made.high > made.low) & (made.y < 0))

    def _useful(self, bundles: Bundles) -> Bundles:
        """Drops bundles that cannot be shortest for any target."""
        surface, h = self.surface, bundles.halfedge
        nearest = np.hypot(np.clip(bundles.x, bundles.low, bundles.high) - bundles.x, bundles.y)
        tie = 1e-12 * surface.diagonal
        keep = bundles.before + nearest <= self._bound()[bundles.source] + tie
        start = self.vertex_distance[bundles.source, surface.start[h]] + bundles.high
        end = self.vertex_distance[bundles.source, surface.end[h]] + surface.length[h] - bundles.low
        keep &= bundles.before + np.hypot(bundles.high - bundles.x, bundles.y) <= start + tie
        keep &= bundles.before + np.hypot(bundles.low - bundles.x, bundles.y) <= end + tie
        return bundles.only(keep)

    def _from_vertices(self) -> Bundles:
        """Bundles of vertices at which paths can bend, if their distances have decreased since they sent bundles."""
        surface = self.surface
        better = (self.vertex_distance < self.sent - 1e-14 * surface.diagonal) & surface.turns_paths & (self.vertex_distance < self._bound()[:, None])
        sources, vertices = np.nonzero(better)
        self.sent[better] = self.vertex_distance[better]
        found = []
        for source, vertex in zip(sources, vertices):
            for h in np.flatnonzero(surface.start == vertex):
                opposite = int(h - h % 3 + (h + 1) % 3)
                if surface.twin[opposite] >= 0:
                    found.append((int(surface.twin[opposite]), float(surface.length[opposite] - surface.apex_x[opposite]), float(-surface.apex_y[opposite]),
                                  int(source), float(self.vertex_distance[source, vertex])))
        return self._useful(self._whole(found))
