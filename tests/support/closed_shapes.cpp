#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "support/parametric.h"
#include "support/shapes.h"

namespace supple::testing {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

Soup icosphere_soup(int subdivisions) {
  const double phi = std::numbers::phi;
  Soup soup;
  for (const Vector3d& p : {Vector3d(-1, phi, 0), Vector3d(1, phi, 0), Vector3d(-1, -phi, 0), Vector3d(1, -phi, 0),
                            Vector3d(0, -1, phi), Vector3d(0, 1, phi), Vector3d(0, -1, -phi), Vector3d(0, 1, -phi),
                            Vector3d(phi, 0, -1), Vector3d(phi, 0, 1), Vector3d(-phi, 0, -1), Vector3d(-phi, 0, 1)}) {
    soup.add(p.normalized());
  }
  soup.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [it, is_new] = middles.try_emplace(std::minmax(a, b), 0);
      if (is_new) it->second = soup.add((soup.positions[a] + soup.positions[b]).normalized());
      return it->second;
    };
    std::vector<surface::Triangle> finer;
    for (const auto& [a, b, c] : soup.faces) {
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    soup.faces = std::move(finer);
  }
  return soup;
}

Soup torus_soup(int around, int across, double major, double minor) {
  return parametric_grid(around, across, Wrap::both, [&](int i, int j) {
    const double u = 2 * pi * i / around, v = 2 * pi * j / across;
    const double r = major + minor * std::cos(v);
    return Vector3d(r * std::cos(u), r * std::sin(u), minor * std::sin(v));
  });
}

// Closes a grid that wraps in u by a fan of faces at its first and at its last row.
void close_ends(Soup& soup, int columns, const Vector3d& first, const Vector3d& last) {
  const auto end = static_cast<std::int32_t>(soup.positions.size());
  const std::int32_t a = soup.add(first), b = soup.add(last);
  for (int i = 0; i < columns; ++i) {
    const int next = (i + 1) % columns;
    soup.faces.push_back({a, next, i});
    soup.faces.push_back({b, end - columns + i, end - columns + next});
  }
}

}  // namespace

TriangleMesh icosphere(int subdivisions) { return icosphere_soup(subdivisions).build(); }

TriangleMesh torus(int around, int across, double major, double minor) {
  return torus_soup(around, across, major, minor).build();
}

TriangleMesh genus3(int n) {
  Soup soup = cell_surface({7, 3, 1}, n, [](int x, int y, int) { return y != 1 || x % 2 == 0; });
  smooth(soup, 2 * n);
  return std::move(soup).build();
}

TriangleMesh rabbit(int n) {
  Soup soup = cell_surface({5, 3, 7}, n, [](int x, int y, int z) {
    if (z < 2) return x < 4 || (z == 0 && y != 1);                       // body and paws
    if (z < 4) return x == 2 || x == 3 || (x == 4 && y == 1 && z == 2);  // head and nose
    return x == 2 && y != 1;                                             // ears
  });
  smooth(soup, n * n);
  return std::move(soup).build();
}

TriangleMesh cube(int n) {
  return cell_surface({1, 1, 1}, n, [](int, int, int) { return true; }).build();
}

TriangleMesh bumpy_cube(int n, double bumps, double amplitude) {
  Soup soup = cell_surface({1, 1, 1}, n, [](int, int, int) { return true; });
  for (Vector3d& p : soup.positions) {
    const Vector3d wave = (2 * pi * bumps * p.array()).sin();
    const Vector3d centred = 2 * p - Vector3d::Ones();
    // Each side moves along its own normal. At the cube's edges the waves of both sides are zero.
    const double height = amplitude * (wave[0] * wave[1] + wave[1] * wave[2] + wave[2] * wave[0]);
    int axis = 0;
    centred.cwiseAbs().maxCoeff(&axis);
    p[axis] += std::copysign(height, centred[axis]);
  }
  return std::move(soup).build();
}

TriangleMesh spiral_cup(int along, int across, double turns) {
  const int rows = along - 1;
  const auto centre = [&](double j) {
    const double angle = 2 * pi * turns * j / rows;
    const double radius = 1 + 0.25 * angle / (2 * pi);
    return Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0.15 * angle / (2 * pi));
  };
  Soup soup = parametric_grid(across, rows, Wrap::u, [&](int i, int j) {
    const double angle = 2 * pi * turns * j / rows, v = -2 * pi * i / across;
    const Vector3d outward(std::cos(angle), std::sin(angle), 0);
    return Vector3d(centre(j) + 0.06 * std::cos(v) * outward + Vector3d(0, 0, 0.4 * std::sin(v)));
  });
  close_ends(soup, across, centre(0), centre(rows));
  return std::move(soup).build();
}

TriangleMesh needle_cylinder(int around, int along, double radius) {
  return parametric_grid(around, along, Wrap::u,
                         [&](int i, int j) {
                           const double angle = 2 * pi * i / around;
                           return Vector3d(radius * std::cos(angle), radius * std::sin(angle),
                                           static_cast<double>(j) / along);
                         })
      .build();
}

TriangleMesh sliver_sphere(int around, int pairs, double gap) {
  const auto on_ring = [&](int i, double latitude) {
    const double longitude = 2 * pi * (i % around) / around;
    return Vector3d(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                    std::sin(latitude));
  };
  Soup soup = parametric_grid(
      around, 2 * pairs - 1, Wrap::u,
      [&](int i, int j) {
        const double latitude = -pi / 2 + pi * (j / 2 + 1) / (pairs + 1);
        if (j % 2 == 0) return on_ring(i, latitude);
        // The vertex is close to the chord of the lower ring, so that the face between them is a sliver.
        return Vector3d(0.6 * on_ring(i, latitude + gap) + 0.4 * on_ring(i + 1, latitude + gap));
      },
      true);
  close_ends(soup, around, {0, 0, -1}, {0, 0, 1});
  return std::move(soup).build();
}

TriangleMesh two_components() {
  Soup soup = icosphere_soup(2);
  soup.append(torus_soup(24, 12, 1.0, 0.4), {3, 0, 0});
  return std::move(soup).build();
}

TriangleMesh trefoil_knot(int along, int across) {
  const double radius = 0.38;
  return parametric_grid(across, along, Wrap::both,
                         [&](int i, int j) {
                           const double t = 2 * pi * j / along, v = -2 * pi * i / across;
                           const Vector3d centre(std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t),
                                                 -std::sin(3 * t));
                           const Vector3d tangent = Vector3d(std::cos(t) + 4 * std::cos(2 * t),
                                                             -std::sin(t) + 4 * std::sin(2 * t), -3 * std::cos(3 * t))
                                                        .normalized();
                           // The knot is nowhere vertical, so that the component of z normal to it gives a continuous
                           // frame.
                           const Vector3d up = (Vector3d::UnitZ() - tangent[2] * tangent).normalized();
                           return Vector3d(centre + radius * (std::cos(v) * tangent.cross(up) + std::sin(v) * up));
                         })
      .build();
}

}  // namespace supple::testing
