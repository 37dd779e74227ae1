#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "cell_meshes.h"
#include "polygon.h"
#include "triangulation.h"

namespace supple::tiling {
namespace {

/// Vertices within this distance (mm) of a side of the parallelogram lie on it: Clipper rounds intersections to 1e-9
/// mm.
constexpr double cut_tolerance = 1e-7;

/// Number of lines that are tried in each direction of the lattice, and of the best ones that are combined to
/// parallelograms.
constexpr int lines_per_direction = 64;
constexpr int combined_lines = 4;

/// The shortest translations that span the lattice (Gauss's reduction), so that cuts are short and meet at wide angles.
Eigen::Matrix2d reduced(Eigen::Matrix2d lattice) {
  while (true) {
    if (lattice.col(0).squaredNorm() > lattice.col(1).squaredNorm()) lattice.col(0).swap(lattice.col(1));
    const double multiple = lattice.col(0).dot(lattice.col(1)) / lattice.col(0).squaredNorm();
    // The tolerance exceeds rounding, lest two equally short translations are exchanged for ever.
    if (std::abs(multiple) < 0.5 + 1e-9) break;
    lattice.col(1) -= std::round(multiple) * lattice.col(0);
  }
  if (lattice.determinant() < 0) lattice.col(1) *= -1;
  return lattice;
}

/// A parallelogram of two translations, along whose sides the solid is cut.
struct Cut {
  Eigen::Matrix2d lattice;
  Eigen::Vector2d origin;

  Polygon outline() const {
    const Eigen::Vector2d a = lattice.col(0), b = lattice.col(1);
    return {origin, origin + a, origin + a + b, origin + b};
  }
  /// The distance of a point from the nearest of the lines through the four sides, mm.
  double distance(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d at = lattice.inverse() * (p - origin);
    const Eigen::Vector2d heights = lattice.inverse().rowwise().norm().cwiseInverse();
    return std::min(std::min(std::abs(at[0]), std::abs(1 - at[0])) * heights[0],
                    std::min(std::abs(at[1]), std::abs(1 - at[1])) * heights[1]);
  }
};

/// The translates of the holes that reach into the parallelogram.
std::vector<Polygon> holes_within(const std::vector<Polygon>& holes, const Cut& cut) {
  const Eigen::Matrix2d inverse = cut.lattice.inverse();
  std::vector<Polygon> result;
  for (const Polygon& hole : holes) {
    Eigen::Array2d lower = Eigen::Array2d::Constant(INFINITY), upper = -lower;
    for (const Eigen::Vector2d& p : hole) {
      const Eigen::Array2d at = inverse * (p - cut.origin);
      lower = lower.min(at);
      upper = upper.max(at);
    }
    const Eigen::Array2i first = (-upper).ceil().cast<int>();
    for (int i = first[0]; lower[0] + i < 1; ++i) {
      for (int j = first[1]; lower[1] + j < 1; ++j) {
        const Eigen::Vector2d translation = cut.lattice * Eigen::Vector2d(i, j);
        Polygon& copy = result.emplace_back(hole);
        for (Eigen::Vector2d& p : copy) p += translation;
      }
    }
  }
  return result;
}

/// How well triangles of side `size` fit between the holes and the line on which the lattice coordinate `direction` is
/// `coordinate_value`: the minimum of 1, of the sines of the angles at which the line crosses holes, and of the
/// distances of their vertices from it over the size.
double line_quality(const std::vector<Polygon>& holes, const Eigen::Matrix2d& lattice, int direction,
                    double coordinate_value, double size) {
  const Eigen::RowVector2d coordinate = lattice.inverse().row(direction);
  const double height = 1 / coordinate.norm();
  double worst = 1;
  for (const Polygon& hole : holes) {
    for (std::size_t k = 0; k < hole.size(); ++k) {
      const Eigen::Vector2d side = hole[(k + 1) % hole.size()] - hole[k];
      // Lattice coordinates of the side's ends, relative to the line. A translate of the side crosses it if an integer
      // lies between them.
      const double from = coordinate.dot(hole[k]) - coordinate_value, to = from + coordinate.dot(side);
      worst = std::min(worst, std::abs(from - std::round(from)) * height / size);
      if (std::floor(from) != std::floor(to)) {
        worst = std::min(worst, std::abs(to - from) * height / side.norm());
      }
    }
  }
  return worst;
}

std::vector<double> best_lines(const std::vector<Polygon>& holes, const Eigen::Matrix2d& lattice, int direction,
                               double size) {
  std::vector<std::pair<double, double>> lines;  // quality, coordinate
  for (int k = 0; k < lines_per_direction; ++k) {
    const double coordinate_value = static_cast<double>(k) / lines_per_direction;
    lines.emplace_back(line_quality(holes, lattice, direction, coordinate_value, size), coordinate_value);
  }
  std::stable_sort(lines.begin(), lines.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<double> best;
  best.reserve(combined_lines);
  for (int k = 0; k < combined_lines; ++k) best.push_back(lines[k].second);
  return best;
}

/// How well triangles of side `size` fit between cut and holes: the minimum of 1, of the sines of angles at the cut,
/// and of the lengths near it over the size.
double quality(const std::vector<Face>& faces, const Cut& cut, double size) {
  double worst = 1;
  for (const Face& face : faces) {
    for (const Polygon& polygon : face) {
      const std::size_t n = polygon.size();
      for (std::size_t k = 0; k < n; ++k) {
        const double distance = cut.distance(polygon[k]);
        if (distance > cut_tolerance) {
          worst = std::min(worst, distance / size);
          continue;
        }
        const Eigen::Vector2d in = polygon[k] - polygon[(k + n - 1) % n], out = polygon[(k + 1) % n] - polygon[k];
        const double lengths = in.norm() * out.norm();
        worst = std::min({worst, in.norm() / size, out.norm() / size});
        // There is no corner if the outline continues along the cut.
        if (in.dot(out) < 0 || std::abs(cross(in, out)) > cut_tolerance * lengths) {
          worst = std::min(worst, std::abs(cross(in, out)) / lengths);
        }
      }
    }
  }
  return worst;
}

}  // namespace

TriangleSoup mesh_by_parallelogram(const Structure& structure, SizeField size) {
  std::vector<Polygon> holes;
  for (const std::vector<Polygon>& of_tile : structure.holes) holes.insert(holes.end(), of_tile.begin(), of_tile.end());
  Cut best = {reduced(structure.tiling.lattice), Eigen::Vector2d::Zero()};
  std::vector<Face> faces;
  double best_quality = -1;
  const std::vector<double> along_second = best_lines(holes, best.lattice, 0, size.max_size());
  const std::vector<double> along_first = best_lines(holes, best.lattice, 1, size.max_size());
  for (const double u : along_second) {
    for (const double v : along_first) {
      const Cut cut = {best.lattice, best.lattice * Eigen::Vector2d(u, v)};
      std::vector<Face> candidate = difference(cut.outline(), holes_within(holes, cut));
      const double candidate_quality = quality(candidate, cut, size.max_size());
      if (candidate_quality > best_quality) {
        best_quality = candidate_quality;
        best = cut;
        faces = std::move(candidate);
      }
    }
  }

  for (const Polygon& hole : holes) size.add_corners(hole);
  size.repeat_corners(best.lattice, best.origin);
  TriangleSoup soup;
  for (Face& face : faces) {
    for (Polygon& polygon : face) {
      Polygon divided;
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        divided.push_back(polygon[k]);
        for (const Eigen::Vector2d& p : size.divide(polygon[k], polygon[(k + 1) % polygon.size()]))
          divided.push_back(p);
      }
      polygon = std::move(divided);
    }
  }
  meshing::PlanarMesh mesh = triangulate(faces, size);
  for (const Eigen::Vector2d& p : mesh.points) soup.seam.push_back(best.distance(p) < cut_tolerance);
  soup.points = std::move(mesh.points);
  soup.triangles = std::move(mesh.triangles);
  return soup;
}

}  // namespace supple::tiling
