#include "morphed_mesh.h"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace supple::bench {
namespace {

/// In beam widths: how far from a hole's side its nodes may lie by rounding.
constexpr double on_side = 1e-6;

/// A side of a hole before and after.
struct MovedSide {
  Eigen::Vector2d from, to;
  Eigen::Vector2d new_from, new_to;
};

/// None where the holes are not the same in number and corners.
std::optional<std::vector<MovedSide>> moved_sides(const tiling::Structure& from, const tiling::Structure& to) {
  if (from.holes.size() != to.holes.size()) return std::nullopt;
  std::vector<MovedSide> sides;
  for (std::size_t tile = 0; tile < from.holes.size(); ++tile) {
    if (from.holes[tile].size() != to.holes[tile].size()) return std::nullopt;
    for (std::size_t h = 0; h < from.holes[tile].size(); ++h) {
      const tiling::Polygon& before = from.holes[tile][h];
      const tiling::Polygon& after = to.holes[tile][h];
      if (before.size() != after.size()) return std::nullopt;
      sides.reserve(sides.size() + before.size());
      for (std::size_t i = 0; i < before.size(); ++i) {
        const std::size_t next = (i + 1) % before.size();
        sides.push_back({before[i], before[next], after[i], after[next]});
      }
    }
  }
  return sides;
}

/// How a point on one of the sides, or on a translate of it, moves in shares of the lattice; none where it is on none.
std::optional<Eigen::Vector2d> moved_share(const Eigen::Vector2d& p, const std::vector<MovedSide>& sides,
                                           const Eigen::Matrix2d& lattice, const Eigen::Matrix2d& new_lattice,
                                           double tolerance) {
  const Eigen::Matrix2d inverse = lattice.inverse();
  for (const MovedSide& side : sides) {
    const Eigen::Vector2d along = side.to - side.from;
    const Eigen::Vector2d nearest = (inverse * (0.5 * (side.from + side.to) - p)).array().round();
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        const Eigen::Vector2d translate = p + lattice * (nearest + Eigen::Vector2d(i, j));
        const double share = std::clamp((translate - side.from).dot(along) / along.squaredNorm(), 0.0, 1.0);
        if ((side.from + share * along - translate).norm() > tolerance) continue;
        const Eigen::Vector2d moved = side.new_from + share * (side.new_to - side.new_from);
        return Eigen::Vector2d(new_lattice.inverse() * moved - inverse * translate);
      }
    }
  }
  return std::nullopt;
}

/// Values at free nodes that are the means of their neighbours' over the sides of the triangles.
void extend_harmonically(const tiling::PeriodicMesh& mesh, const std::vector<bool>& held, Eigen::MatrixX2d& values) {
  std::vector<int> unknown(held.size(), -1);
  int n = 0;
  for (const auto& nodes : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto node = static_cast<std::size_t>(nodes[k]);
      if (!held[node] && unknown[node] < 0) unknown[node] = n++;
    }
  if (n == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(12 * mesh.triangles.size());
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(n, 2);
  for (const auto& nodes : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      // Inner sides have two triangles, each of which adds half.
      const int ends[] = {nodes[k], nodes[(k + 1) % 3]};
      for (const auto& [a, b] : {std::pair{ends[0], ends[1]}, std::pair{ends[1], ends[0]}}) {
        const int row = unknown[static_cast<std::size_t>(a)];
        if (row < 0) continue;
        entries.emplace_back(row, row, 0.5);
        const int column = unknown[static_cast<std::size_t>(b)];
        if (column >= 0)
          entries.emplace_back(row, column, -0.5);
        else
          right.row(row) += 0.5 * values.row(b);
      }
    }
  }
  Eigen::SparseMatrix<double> laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(laplacian);
  const Eigen::MatrixX2d solution = solver.solve(right);
  for (std::size_t node = 0; node < unknown.size(); ++node)
    if (unknown[node] >= 0) values.row(static_cast<Eigen::Index>(node)) = solution.row(unknown[node]);
}

}  // namespace

std::optional<tiling::PeriodicMesh> morphed(const tiling::PeriodicMesh& mesh, const tiling::Structure& from,
                                            const tiling::Structure& to) {
  const auto sides = moved_sides(from, to);
  if (!sides) return std::nullopt;
  tiling::PeriodicMesh result = mesh;
  result.lattice = to.tiling.lattice;
  std::vector<bool> held(static_cast<std::size_t>(mesh.nodes.cols()), false);
  Eigen::MatrixX2d shares = Eigen::MatrixX2d::Zero(mesh.nodes.cols(), 2);
  for (const auto& side : mesh.outline) {
    for (const int k : {side.side, (side.side + 1) % 3}) {
      const int node = mesh.triangles[static_cast<std::size_t>(side.triangle)][static_cast<std::size_t>(k)];
      if (held[static_cast<std::size_t>(node)]) continue;
      const auto moved =
          moved_share(mesh.nodes.col(node), *sides, mesh.lattice, result.lattice, on_side * mesh.beam_width);
      if (!moved) return std::nullopt;
      shares.row(node) = moved->transpose();
      held[static_cast<std::size_t>(node)] = true;
    }
  }
  extend_harmonically(mesh, held, shares);
  result.nodes = result.lattice * (mesh.lattice.inverse() * mesh.nodes + shares.transpose());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto shift = [&](std::size_t k) {
      return Eigen::Vector2d(result.lattice * Eigen::Vector2d(mesh.shifts[t][k].first, mesh.shifts[t][k].second));
    };
    const auto at = [&](std::size_t k) { return Eigen::Vector2d(result.nodes.col(mesh.triangles[t][k]) + shift(k)); };
    const Eigen::Vector2d corners[] = {at(0), at(1), at(2)};
    const Eigen::Vector2d first = corners[1] - corners[0];
    const Eigen::Vector2d second = corners[2] - corners[0];
    if (!(first.x() * second.y() - first.y() * second.x() > 0)) return std::nullopt;
    // Sides stay straight.
    for (std::size_t k = 0; k < 3; ++k)
      result.nodes.col(mesh.triangles[t][3 + k]) = 0.5 * (corners[k] + corners[(k + 1) % 3]) - shift(3 + k);
  }
  return result;
}

}  // namespace supple::bench
