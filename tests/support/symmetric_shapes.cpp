#include "support/symmetric_shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "support/nearest_point.h"
#include "support/parametric.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::testing {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using surface::SurfacePoint;

using Symmetry = Eigen::Affine3d;

/// A shape without sites.
struct Shape {
  std::string name;
  TriangleMesh mesh;
  std::vector<Symmetry> symmetries;  ///< the identity first
};

Symmetry turn(double angle, const Vector3d& axis, const Vector3d& centre = Vector3d::Zero()) {
  return Eigen::Translation3d(centre) * Eigen::AngleAxisd(angle, axis.normalized()) * Eigen::Translation3d(-centre);
}

Symmetry mirror(const Vector3d& normal, const Vector3d& centre = Vector3d::Zero()) {
  const Vector3d n = normal.normalized();
  const Eigen::Matrix3d reflection = Eigen::Matrix3d::Identity() - 2 * n * n.transpose();
  return Eigen::Translation3d(centre) * Eigen::Affine3d(reflection) * Eigen::Translation3d(-centre);
}

/// The finite group that some generators generate.
std::vector<Symmetry> group(const std::vector<Symmetry>& generators) {
  std::vector<Symmetry> found{Symmetry::Identity()};
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const Symmetry& generator : generators) {
      const Symmetry next = generator * found[i];
      const auto same = [&](const Symmetry& other) { return (other.matrix() - next.matrix()).norm() < 1e-9; };
      if (std::none_of(found.begin(), found.end(), same)) found.push_back(next);
    }
  }
  return found;
}

/// Rotations whose number is a random divisor of `order`, at least two.
std::vector<Symmetry> turns(int order, RandomStream& stream) {
  std::vector<int> divisors;
  for (int d = 2; d <= order; ++d)
    if (order % d == 0) divisors.push_back(d);
  const int parts = divisors[static_cast<std::size_t>(stream.below(static_cast<int>(divisors.size())))];
  return group({turn(2 * pi / parts, Vector3d::UnitZ())});
}

Shape torus_shape(RandomStream& stream) {
  const int around = 2 * (2 + stream.below(5));
  const int across = 3 + stream.below(4);
  const double minor = stream.uniform(0.15, 0.45);
  const bool from_b = stream.below(2) == 0;
  Soup soup = parametric_grid(
      around, across, Wrap::both,
      [&](int i, int j) {
        const double u = 2 * pi * i / around;
        const double v = 2 * pi * j / across;
        const double r = 1 + minor * std::cos(v);
        return Vector3d(r * std::cos(u), r * std::sin(u), minor * std::sin(v));
      },
      from_b);
  return {"torus", std::move(soup).build(), turns(around, stream)};
}

Shape box_shape(RandomStream& stream) {
  const Eigen::Vector3i size(1 + stream.below(3), 1 + stream.below(3), 1 + stream.below(2));
  const int n = 1 + stream.below(3);
  const Vector3d centre = 0.5 * size.cast<double>();
  std::vector<Symmetry> generators;
  for (int axis = 0; axis < 3; ++axis) {
    const int draw = stream.below(3);
    if (draw == 0) generators.push_back(turn(pi, Vector3d::Unit(axis), centre));
    if (draw == 1) generators.push_back(mirror(Vector3d::Unit(axis), centre));
  }
  if (generators.empty()) generators.push_back(turn(pi, Vector3d::UnitZ(), centre));
  return {"box", cell_surface(size, n, [](int, int, int) { return true; }).build(), group(generators)};
}

/// A tube about the z axis, whose ends are closed by fans if `closed`.
Shape tube_shape(bool closed, RandomStream& stream) {
  const int around = 3 + stream.below(6);
  const int along = 1 + stream.below(3);
  const double height = stream.uniform(0.3, 3);
  const bool from_b = stream.below(2) == 0;
  Soup soup = parametric_grid(
      around, along, Wrap::u,
      [&](int i, int j) {
        const double u = 2 * pi * i / around;
        return Vector3d(std::cos(u), std::sin(u), height * (static_cast<double>(j) / along - 0.5));
      },
      from_b);
  if (closed) {
    const std::int32_t bottom = soup.add({0, 0, -0.5 * height});
    const std::int32_t top = soup.add({0, 0, 0.5 * height});
    for (int i = 0; i < around; ++i) {
      const int next = (i + 1) % around;
      soup.faces.push_back({bottom, next, i});
      soup.faces.push_back({top, along * around + i, along * around + next});
    }
  }
  std::vector<Symmetry> symmetries = stream.below(3) == 0 ? group({mirror(Vector3d::UnitZ())}) : turns(around, stream);
  return {closed ? "prism" : "tube", std::move(soup).build(), std::move(symmetries)};
}

/// The squares of a plane grid for which `filled` is true, each cut along one of its diagonals.
TriangleMesh plane_squares(int nx, int ny, const std::function<bool(int i, int j)>& filled,
                           const std::function<bool(int i, int j)>& from_b) {
  Soup soup;
  std::vector<std::int32_t> numbers(static_cast<std::size_t>((nx + 1) * (ny + 1)), -1);
  const auto vertex = [&](int i, int j) {
    std::int32_t& number = numbers[static_cast<std::size_t>(j * (nx + 1) + i)];
    if (number < 0) number = soup.add(Vector3d(i, j, 0));
    return number;
  };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      if (filled(i, j))
        soup.add_quad(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1), from_b(i, j));
  return std::move(soup).build();
}

std::function<bool(int, int)> drawn_diagonals(RandomStream& stream) {
  const int draw = stream.below(4);
  const auto seed = static_cast<unsigned>(stream.below(1 << 16));
  return [draw, seed](int i, int j) {
    if (draw < 2) return draw == 0;
    if (draw == 2) return (i + j) % 2 == 0;
    return ((seed >> static_cast<unsigned>((3 * i + 5 * j) % 16)) & 1U) != 0;
  };
}

Shape rectangle_shape(RandomStream& stream) {
  const int nx = 1 + stream.below(6);
  const int ny = 1 + stream.below(6);
  const Vector3d centre(0.5 * nx, 0.5 * ny, 0);
  std::vector<Symmetry> generators;
  if (stream.below(2) == 0) generators.push_back(mirror(Vector3d::UnitX(), centre));
  if (stream.below(2) == 0) generators.push_back(mirror(Vector3d::UnitY(), centre));
  if (nx == ny && stream.below(2) == 0) generators.push_back(mirror(Vector3d(1, -1, 0), centre));
  if (generators.empty()) generators.push_back(turn(pi, Vector3d::UnitZ(), centre));
  return {"rectangle",
          plane_squares(
              nx, ny, [](int, int) { return true; }, drawn_diagonals(stream)),
          group(generators)};
}

Shape l_shape_of_squares(RandomStream& stream) {
  const int n = 2 + stream.below(5);
  const int width = 1 + stream.below(n - 1);
  return {"L",
          plane_squares(
              n, n, [&](int i, int j) { return i < width || j < width; }, drawn_diagonals(stream)),
          group({mirror(Vector3d(1, -1, 0))})};
}

/// A flat strip around a square hole.
Shape holed_shape(RandomStream& stream) {
  const int border = 1 + stream.below(2);
  const int n = 2 * border + 1 + stream.below(3);
  const Vector3d centre(0.5 * n, 0.5 * n, 0);
  std::vector<Symmetry> generators;
  if (stream.below(2) == 0) generators.push_back(mirror(Vector3d::UnitX(), centre));
  if (stream.below(2) == 0) generators.push_back(mirror(Vector3d(1, -1, 0), centre));
  if (generators.empty()) generators.push_back(turn(stream.below(2) == 0 ? pi : pi / 2, Vector3d::UnitZ(), centre));
  const auto inside = [&](int i) { return i >= border && i < n - border; };
  return {"holed plate",
          plane_squares(
              n, n, [&](int i, int j) { return !(inside(i) && inside(j)); }, drawn_diagonals(stream)),
          group(generators)};
}

Shape octahedron_shape(RandomStream& stream) {
  const int n = 1 + stream.below(4);
  const double stretch = stream.below(2) == 0 ? 1 : stream.uniform(0.3, 3);
  Soup soup;
  const std::array<Vector3d, 6> tips{Vector3d(1, 0, 0),  Vector3d(0, 1, 0), Vector3d(-1, 0, 0),
                                     Vector3d(0, -1, 0), Vector3d(0, 0, 1), Vector3d(0, 0, -1)};
  const auto vertex = [&](const Vector3d& p) {
    for (std::size_t i = 0; i < soup.positions.size(); ++i)
      if ((soup.positions[i] - p).norm() < 1e-9) return static_cast<std::int32_t>(i);
    return soup.add(p);
  };
  for (std::size_t k = 0; k < 8; ++k) {
    const Vector3d& a = tips[k % 4];
    const Vector3d& b = tips[(k + 1) % 4];
    const Vector3d& c = tips[k < 4 ? 4 : 5];
    const auto at = [&](int i, int j) {
      const Vector3d p = (a * (n - i - j) + b * i + c * j) / n;
      return vertex({p.x(), p.y(), stretch * p.z()});
    };
    const auto add = [&](std::int32_t u, std::int32_t v, std::int32_t w) {
      if (k < 4)
        soup.faces.push_back({u, v, w});
      else
        soup.faces.push_back({u, w, v});
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i + j < n; ++i) {
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j < n - 1) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  }
  std::vector<Symmetry> generators;
  if (stream.below(2) == 0) generators.push_back(turn(pi / 2, Vector3d::UnitZ()));
  if (stream.below(2) == 0) generators.push_back(mirror(Vector3d::UnitZ()));
  if (generators.empty()) generators.push_back(turn(pi, Vector3d(1, 1, 0)));
  return {"octahedron", std::move(soup).build(), group(generators)};
}

Shape drawn_shape(int family, RandomStream& stream) {
  switch (family) {
    case 0:
      return torus_shape(stream);
    case 1:
      return box_shape(stream);
    case 2:
      return tube_shape(true, stream);
    case 3:
      return tube_shape(false, stream);
    case 4:
      return rectangle_shape(stream);
    case 5:
      return l_shape_of_squares(stream);
    case 6:
      return holed_shape(stream);
    default:
      return octahedron_shape(stream);
  }
}

SurfacePoint drawn_place(const TriangleMesh& mesh, RandomStream& stream, std::string& name) {
  const int draw = stream.below(5);
  SurfacePoint point = random_vertex_point(mesh, stream);
  switch (draw) {
    case 0:
      name += ", at a vertex";
      return point;
    case 1:
      name += ", at the middle of an edge";
      point.barycentric = 0.5 * (Vector3d::Ones() - Vector3d::Unit(corner_of(point)));
      return point;
    case 2:
      name += ", on an edge";
      return random_edge_point(mesh, stream);
    case 3:
      name += ", at the middle of a face";
      point.barycentric = Vector3d::Constant(1.0 / 3);
      return point;
    default:
      name += ", in a face";
      return random_point(mesh, stream);
  }
}

}  // namespace

SymmetricSites random_symmetric_sites(int family, RandomStream& stream) {
  SymmetricSites result;
  while (result.sites.size() < 2) {
    Shape shape = drawn_shape(family, stream);
    result = {shape.name + " of " + std::to_string(shape.mesh.face_count()) + " faces, " +
                  std::to_string(shape.symmetries.size()) + " symmetries",
              std::move(shape.mesh),
              {},
              {}};
    const int orbits = 1 + stream.below(2);
    for (int orbit = 0; orbit < orbits; ++orbit) {
      const Vector3d place = position(result.mesh, drawn_place(result.mesh, stream, result.name));
      for (const Symmetry& symmetry : shape.symmetries) {
        const SurfacePoint image = nearest_point(result.mesh, symmetry * place);
        const auto same = [&](const SurfacePoint& other) {
          return (position(result.mesh, other) - position(result.mesh, image)).norm() < 1e-6;
        };
        // A place on an axis or a plane of symmetry is its own image.
        if (std::any_of(result.sites.begin(), result.sites.end(), same)) continue;
        result.sites.push_back(image);
        result.orbits.push_back(orbit);
      }
    }
  }
  return result;
}

SymmetricSites disturbed(const SymmetricSites& sites, const Disturbance& disturbance, RandomStream& stream) {
  std::vector<Vector3d> positions = sites.mesh.positions();
  SymmetricSites result = sites;
  if (disturbance.turned) {
    result.name += ", turned";
    const Vector3d axis(stream.normal(), stream.normal(), stream.normal());
    const Symmetry moved =
        Eigen::Translation3d(stream.normal(), stream.normal(), stream.normal()) * turn(stream.uniform(0, 2 * pi), axis);
    for (Vector3d& p : positions) p = moved * p;
  }
  if (disturbance.noise > 0) {
    result.name += ", noise " + std::to_string(std::log10(disturbance.noise));
    const double reach = disturbance.noise * sites.mesh.diagonal();
    for (Vector3d& p : positions)
      p += reach * Vector3d(stream.uniform(-1, 1), stream.uniform(-1, 1), stream.uniform(-1, 1));
  }
  if (disturbance.float32) {
    result.name += ", float32";
    for (Vector3d& p : positions) p = p.cast<float>().cast<double>();
  }
  result.mesh = sites.mesh.with_positions(std::move(positions));
  return result;
}

TriangleMesh exported_ring(int around) {
  Soup soup;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < 4; ++j) {
      const double t = 2 * pi * i / around;
      const double p = 2 * pi * j / 4;
      const double r = 2 + 0.4 * std::cos(p);
      const Vector3d exact(r * std::cos(t), r * std::sin(t), 0.4 * std::sin(p));
      soup.add((exact * 1e4).array().round() / 1e4);
    }
  }
  const auto vertex = [&](int i, int j) { return (i % around) * 4 + j % 4; };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < 4; ++j) soup.add_quad(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1));
  return std::move(soup).build();
}

}  // namespace supple::testing
