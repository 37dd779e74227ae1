#include <cmath>
#include <numbers>
#include <stdexcept>

#include "support/parametric.h"
#include "support/shapes.h"

namespace supple::testing {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// A disk: a fan of faces between vertex 0 and the ring of vertices 1 to n, then strips between rings of n vertices.
Soup disk(int n, int rings, const Vector3d& centre, const std::function<Vector3d(int i, int ring)>& at) {
  Soup soup;
  soup.add(centre);
  for (int ring = 1; ring <= rings; ++ring) {
    for (int i = 0; i < n; ++i) soup.add(at(i, ring));
  }
  for (int i = 0; i < n; ++i) soup.faces.push_back({0, 1 + i, 1 + (i + 1) % n});
  for (int ring = 1; ring < rings; ++ring) {
    const int inner = 1 + (ring - 1) * n, outer = inner + n;
    for (int i = 0; i < n; ++i) {
      const int next = (i + 1) % n;
      soup.add_quad(inner + i, outer + i, outer + next, inner + next, i % 2 == 1);
    }
  }
  return soup;
}

}  // namespace

TriangleMesh saddle(int n) {
  return parametric_grid(n, n, Wrap::none,
                         [&](int i, int j) {
                           const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
                           return Vector3d(x, y, x * x - y * y);
                         })
      .build();
}

TriangleMesh open_hemisphere(int around, int rings) {
  return disk(around, rings, {0, 0, 1},
              [&](int i, int ring) {
                const double polar = 0.5 * pi * ring / rings, longitude = 2 * pi * i / around;
                return Vector3d(std::sin(polar) * std::cos(longitude), std::sin(polar) * std::sin(longitude),
                                std::cos(polar));
              })
      .build();
}

TriangleMesh slit_annulus(int around, int rings) {
  return parametric_grid(around, rings, Wrap::none,
                         [&](int i, int j) {
                           // The last column has exactly the coordinates of the first one.
                           const double angle = 2 * pi * (i % around) / around, radius = 1 - 0.5 * j / rings;
                           return Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0);
                         })
      .build();
}

TriangleMesh l_shape(int n) {
  Soup soup;
  std::vector<std::int32_t> numbers((2 * n + 1) * (2 * n + 1), -1);
  const auto vertex = [&](int i, int j) {
    std::int32_t& number = numbers[j * (2 * n + 1) + i];
    if (number < 0) number = soup.add({static_cast<double>(i) / n, static_cast<double>(j) / n, 0});
    return number;
  };
  for (int j = 0; j < 2 * n; ++j) {
    for (int i = 0; i < (j < n ? 2 * n : n); ++i) {
      soup.add_quad(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1), (i + j) % 2 == 1);
    }
  }
  return std::move(soup).build();
}

TriangleMesh flat_grid(int nx, int ny) {
  return parametric_grid(nx, ny, Wrap::none, [](int i, int j) { return Vector3d(i, j, 0); }).build();
}

TriangleMesh jittered_grid(int nx, int ny, RandomStream& stream) {
  Soup soup;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      Vector3d p(i, j, 0);
      // Displacements below 1/4 of the side along each diagonal leave every quadrilateral convex. 0.3 may not, so that
      // both diagonals of a quadrilateral are tried below.
      if (i > 0 && i < nx) p[0] += stream.uniform(-0.3, 0.3);
      if (j > 0 && j < ny) p[1] += stream.uniform(-0.3, 0.3);
      soup.add(p);
    }
  }
  const auto doubled_area = [&](int a, int b, int c) {
    const Vector3d u = soup.positions[b] - soup.positions[a], v = soup.positions[c] - soup.positions[a];
    return u[0] * v[1] - u[1] * v[0];
  };
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i, b = a + 1, d = a + nx + 1, c = d + 1;
      const bool from_a = doubled_area(a, b, c) > 0.01 && doubled_area(a, c, d) > 0.01;
      const bool from_b = doubled_area(a, b, d) > 0.01 && doubled_area(b, c, d) > 0.01;
      const bool wanted_b = stream.below(2) == 1;
      soup.add_quad(a, b, c, d, from_a && from_b ? wanted_b : from_b);
    }
  }
  return std::move(soup).build();
}

TriangleMesh cone(int n, double total_angle, int rings) {
  const double sector = total_angle / n, turn = 2 * pi / n;
  // Rim points at unit distance from the apex, at which two neighbouring points span the angle `sector`.
  std::function<Vector3d(int)> rim;
  if (total_angle <= 2 * pi) {
    const double radius = std::sin(sector / 2) / std::sin(turn / 2);
    const double depth = std::sqrt(std::max(0.0, 1 - radius * radius));
    rim = [=](int i) { return Vector3d(radius * std::cos(turn * i), radius * std::sin(turn * i), -depth); };
  } else {
    if (n % 2 != 0 || sector >= pi) throw std::invalid_argument("a saddle cone needs even n and sectors below pi");
    // Rim points are alternately above and below: cos(sector) = c^2 (1 + cos(turn)) - 1, with the cosine c of the
    // elevation.
    const double c = std::sqrt((1 + std::cos(sector)) / (1 + std::cos(turn)));
    const double s = std::sqrt(1 - c * c);
    rim = [=](int i) { return Vector3d(c * std::cos(turn * i), c * std::sin(turn * i), i % 2 == 0 ? s : -s); };
  }
  return disk(n, rings, Vector3d::Zero(),
              [&](int i, int ring) { return Vector3d(rim(i) * (static_cast<double>(ring) / rings)); })
      .build();
}

}  // namespace supple::testing
