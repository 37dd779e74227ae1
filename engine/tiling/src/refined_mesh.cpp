#include "supple/tiling/refined_mesh.h"

#include <map>
#include <tuple>

namespace supple::tiling {
namespace {

/// The key of the node in the middle of half a side: the nodes at the side's midpoint and at the half's corner, and the
/// lattice shift from midpoint to corner. The shift is needed because a side may begin and end at translates of one
/// node.
using HalfSide = std::tuple<int, int, int, int>;

constexpr std::size_t next(std::size_t corner) { return (corner + 1) % 3; }
constexpr std::size_t before(std::size_t corner) { return (corner + 2) % 3; }

/// The quadratic shape functions in the middle of the half of side `side` that ends at the corner `near`.
std::array<double, 6> weights_on_side(std::size_t side, std::size_t near, std::size_t far) {
  std::array<double, 6> weights{};
  weights[near] = 3.0 / 8;
  weights[far] = -1.0 / 8;
  weights[3 + side] = 3.0 / 4;
  return weights;
}

/// The quadratic shape functions in the middle between the midpoints of the two sides that meet at `corner`.
std::array<double, 6> weights_before(std::size_t corner) {
  std::array<double, 6> weights{};
  weights[next(corner)] = weights[before(corner)] = -1.0 / 8;
  weights[3 + corner] = weights[3 + before(corner)] = 1.0 / 2;
  weights[3 + next(corner)] = 1.0 / 4;
  return weights;
}

/// Adds the new nodes and the children of one triangle after the other.
class Division {
 public:
  Division(const PeriodicMesh& coarse, RefinedMesh& fine) : coarse_(coarse), fine_(fine) {
    fine_.mesh.triangles.reserve(4 * coarse.triangles.size());
    fine_.mesh.shifts.reserve(4 * coarse.triangles.size());
  }

  void divide(std::size_t t) {
    const auto& nodes = coarse_.triangles[t];
    const auto& shifts = coarse_.shifts[t];
    // For each side, the nodes in the middle of its first and of its second half; for each corner, the node in the
    // middle of the new side that cuts it off.
    std::array<int, 3> first{}, second{}, cut{};
    for (std::size_t k = 0; k < 3; ++k) {
      first[k] = on_side(t, k, k, next(k));
      second[k] = on_side(t, k, next(k), k);
      cut[k] = add(t, (position(t, 3 + k) + position(t, 3 + before(k))) / 2, shifts[3 + k], weights_before(k));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t b = before(k);
      fine_.mesh.triangles.push_back({nodes[k], nodes[3 + k], nodes[3 + b], first[k], cut[k], second[b]});
      fine_.mesh.shifts.push_back(
          {shifts[k], shifts[3 + k], shifts[3 + b], shifts[3 + k], shifts[3 + k], shifts[3 + b]});
    }
    // The side of the middle triangle from the midpoint of side k to that of the next one cuts off the corner between.
    fine_.mesh.triangles.push_back({nodes[3], nodes[4], nodes[5], cut[1], cut[2], cut[0]});
    fine_.mesh.shifts.push_back({shifts[3], shifts[4], shifts[5], shifts[4], shifts[5], shifts[3]});
  }

  const std::vector<Eigen::Vector2d>& added() const { return added_; }

 private:
  Eigen::Vector2d position(std::size_t t, std::size_t k) const {
    return coarse_.corner(static_cast<int>(t), static_cast<int>(k));
  }

  int add(std::size_t t, const Eigen::Vector2d& point, const LatticeShift& shift,
          const std::array<double, 6>& weights) {
    added_.emplace_back(point - coarse_.lattice * Eigen::Vector2d(shift.first, shift.second));
    fine_.parents.push_back({coarse_.triangles[t], weights});
    return static_cast<int>(coarse_.nodes.cols() + static_cast<Eigen::Index>(added_.size()) - 1);
  }

  /// The node in the middle of that half of a side which ends at the corner `near`. The first triangle that has the
  /// side adds it. In all triangles, it has the shift of the side's midpoint.
  int on_side(std::size_t t, std::size_t side, std::size_t near, std::size_t far) {
    const LatticeShift& middle = coarse_.shifts[t][3 + side];
    const LatticeShift& end = coarse_.shifts[t][near];
    const HalfSide key(coarse_.triangles[t][3 + side], coarse_.triangles[t][near], end.first - middle.first,
                       end.second - middle.second);
    const auto found = half_side_nodes_.find(key);
    if (found != half_side_nodes_.end()) return found->second;
    const int node = add(t, (position(t, near) + position(t, 3 + side)) / 2, middle, weights_on_side(side, near, far));
    half_side_nodes_.emplace(key, node);
    return node;
  }

  const PeriodicMesh& coarse_;
  RefinedMesh& fine_;
  std::map<HalfSide, int> half_side_nodes_;
  std::vector<Eigen::Vector2d> added_;
};

}  // namespace

RefinedMesh refine(const PeriodicMesh& mesh) {
  RefinedMesh result;
  result.coarse_nodes = mesh.nodes.cols();
  PeriodicMesh& fine = result.mesh;
  fine.lattice = mesh.lattice;
  fine.cells_first = mesh.cells_first;
  fine.cells_second = mesh.cells_second;
  fine.mesh_size = mesh.mesh_size / 2;
  fine.beam_width = mesh.beam_width;
  Division division(mesh, result);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) division.divide(t);
  fine.nodes.resize(2, mesh.nodes.cols() + static_cast<Eigen::Index>(division.added().size()));
  fine.nodes.leftCols(mesh.nodes.cols()) = mesh.nodes;
  for (std::size_t k = 0; k < division.added().size(); ++k)
    fine.nodes.col(mesh.nodes.cols() + static_cast<Eigen::Index>(k)) = division.added()[k];
  // Child k of a triangle has the first half of side k as its side 0, and the second half of the side before as its
  // side 2.
  fine.outline.reserve(2 * mesh.outline.size());
  for (const auto& [triangle, side] : mesh.outline) {
    fine.outline.push_back({4 * triangle + side, 0});
    fine.outline.push_back({4 * triangle + (side + 1) % 3, 2});
  }
  return result;
}

Eigen::Matrix2Xd RefinedMesh::prolong(const Eigen::Matrix2Xd& coarse) const {
  Eigen::Matrix2Xd fine(2, mesh.nodes.cols());
  fine.leftCols(coarse_nodes) = coarse;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    const Parent& parent = parents[i];
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::size_t j = 0; j < 6; ++j) sum += parent.weights[j] * coarse.col(parent.nodes[j]);
    fine.col(coarse_nodes + static_cast<Eigen::Index>(i)) = sum;
  }
  return fine;
}

}  // namespace supple::tiling
