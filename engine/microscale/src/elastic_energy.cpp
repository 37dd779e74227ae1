#include "elastic_energy.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "elastic_kernel.h"
#include "jacobian_bounds.h"
#include "supple/numerics/element_loop.h"

namespace supple::microscale {
namespace {

/// Fraction that a step may take of the step that inverts an integration point. The energy is finite there but steep.
constexpr double max_inversion_fraction = 0.9;

/// Strain whose forces are added to the force scale.
constexpr double reference_strain = 1e-6;
/// Rounding errors of the gradient, relative to the forces of a stress of Young's modulus. Deformation gradients are
/// rounded near 1.
constexpr double relative_rounding = 16 * std::numeric_limits<double>::epsilon();

/// Number of batches in one task of a parallel loop.
constexpr std::size_t batches_per_task = 16;

}  // namespace

/// Connects the degrees of freedom of batches with those of the patch. Local nodes are those of elastic_kernel.h: the
/// six nodes, then the two columns of F.
struct ElasticEnergy::Kernel {
  /// Index of the patch's degree of freedom for component i of local node k in one lane.
  static Eigen::Index index(const Batch& batch, const CellCoordinates& coordinates, int k, int i, int lane) {
    if (k < 6) return coordinates.displacement(batch.node[k][lane]) + i;
    return coordinates.strain() + 2 * i + (k - 6);
  }

  using Entries = numerics::HessianEntries;
  using Block = std::array<std::int32_t, 12>;
  static constexpr std::size_t block_entries = Entries::entries_of(std::tuple_size_v<Block>);

  static Block rows(const Batch& batch, int lane) {
    Block rows;
    for (std::size_t k = 0; k < 6; ++k)
      for (std::size_t i = 0; i < 2; ++i)
        rows[2 * k + i] = static_cast<std::int32_t>(2 * batch.node[k][lane] + static_cast<int>(i));
    return rows;
  }

  /// The lower triangle of one lane's stiffness between its nodes, row by row, with a sign for each node.
  static void nodal_stiffness(const Batch& batch, const ElasticBatch& local, int lane, const double (&sign)[6],
                              double* lower) {
    for (int k = 0; k < 6; ++k) {
      const auto* pairs = &local.stiffness[k * (k + 1) / 2];
      for (int i = 0; i < 2; ++i) {
        for (int l = 0; l < k; ++l)
          for (int j = 0; j < 2; ++j) *lower++ = sign[k] * sign[l] * pairs[l][i][j][lane];
        for (int j = 0; j <= i; ++j) *lower++ = pairs[k][i][j][lane];
      }
    }
    if (batch.distinct[lane]) return;
    // On a patch of very few triangles, two nodes of a triangle can be images of one node. Then both off-diagonal
    // entries of the pair belong to the same entry of the patch's diagonal.
    const Block all = rows(batch, lane);
    lower -= Entries::entries_of(all.size());
    for (std::size_t k = 0; k < all.size(); ++k)
      for (std::size_t l = 0; l <= k; ++l, ++lower)
        if (l != k && all[k] == all[l]) *lower *= 2;
  }

  /// A batch that was evaluated at a state.
  struct Evaluated {
    bool valid;  ///< whether det F > 0 at all integration points
    ElasticBatch local;
  };

  static void add_stiffness(const Batch& batch, const CellCoordinates& coordinates, const ElasticBatch& local, int lane,
                            Entries& entries) {
    constexpr double plus[6] = {1, 1, 1, 1, 1, 1};
    double block[block_entries];
    nodal_stiffness(batch, local, lane, plus, block);
    entries.add_block(rows(batch, lane), block);
    // Local nodes 6 and 7 are the columns of F. In the coordinates, component i of both is at 2 i and 2 i + 1.
    const auto* first = &local.stiffness[6 * 7 / 2];
    const auto* second = &local.stiffness[7 * 8 / 2];
    for (int l = 0; l < 6; ++l)
      for (int j = 0; j < 2; ++j) {
        const double row[4] = {first[l][0][j][lane], second[l][0][j][lane], first[l][1][j][lane],
                               second[l][1][j][lane]};
        entries.add_row<4>(coordinates.displacement(batch.node[l][lane]) + j, coordinates.strain(), row);
      }
    for (int k = 6; k < 8; ++k)
      for (int l = 6; l <= k; ++l)
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < (l == k ? i + 1 : 2); ++j)
            entries.add(index(batch, coordinates, k, i, lane), index(batch, coordinates, l, j, lane),
                        local.stiffness[k * (k + 1) / 2 + l][i][j][lane]);
  }

  static void gather(const Batch& batch, const Eigen::VectorXd& x, ElasticBatch& local) {
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 2; ++i)
        for (int lane = 0; lane < lanes; ++lane) local.barycentric_gradient[k][i][lane] = batch.gradient[k][i][lane];
    for (int lane = 0; lane < lanes; ++lane) local.area[lane] = batch.area[lane];
    for (int k = 0; k < 6; ++k)
      for (int lane = 0; lane < lanes; ++lane)
        for (int i = 0; i < 2; ++i) local.displacement[k][i][lane] = x[2 * batch.node[k][lane] + i];
    const Eigen::Index strain = x.size() - CellCoordinates::strain_components;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        for (int lane = 0; lane < lanes; ++lane) local.strain_change[i][j][lane] = x[strain + 2 * i + j];
  }
};

ElasticEnergy::ElasticEnergy(const tiling::PeriodicMesh& mesh, const Material& material)
    : coordinates_{mesh.nodes.cols()}, law_(material) {
  batches_.resize((mesh.triangles.size() + lanes - 1) / lanes);
  for (std::size_t slot = 0; slot < batches_.size() * lanes; ++slot) {
    Batch& batch = batches_[slot / lanes];
    const std::size_t lane = slot % lanes;
    const std::size_t t = std::min(slot, mesh.triangles.size() - 1);
    const Eigen::Vector2d a = mesh.corner(static_cast<int>(t), 0);
    Eigen::Matrix2d sides;
    sides << mesh.corner(static_cast<int>(t), 1) - a, mesh.corner(static_cast<int>(t), 2) - a;
    const Eigen::Matrix2d inverse = sides.inverse();
    for (int i = 0; i < 2; ++i) {
      batch.gradient[1][i][lane] = inverse(0, i);
      batch.gradient[2][i][lane] = inverse(1, i);
      batch.gradient[0][i][lane] = -inverse(0, i) - inverse(1, i);
    }
    batch.area[lane] = slot < mesh.triangles.size() ? sides.determinant() / 2 : 0;
    std::array<int, 6> nodes = mesh.triangles[t];
    std::sort(nodes.begin(), nodes.end());
    batch.distinct[lane] = std::adjacent_find(nodes.begin(), nodes.end()) == nodes.end();
    const double force = material.youngs_modulus * batch.area[lane] * inverse.norm();
    unit_forces_ += force * force;
    for (int k = 0; k < 6; ++k) {
      batch.node[k][lane] = mesh.triangles[t][static_cast<std::size_t>(k)];
      batch.shift[k][lane] = mesh.shifts[t][static_cast<std::size_t>(k)];
    }
  }
  unit_forces_ = std::sqrt(unit_forces_);
}

std::string_view ElasticEnergy::name() const { return to_string(law_.law); }

void ElasticEnergy::add(const CellState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.x;
  const auto evaluate = [&](std::size_t b, Kernel::Evaluated& evaluated) {
    Kernel::gather(batches_[b], x, evaluated.local);
    evaluated.valid = integrate(law_, order, evaluated.local);
  };
  const auto add = [&](std::size_t b, const Kernel::Evaluated& evaluated) {
    const Batch& batch = batches_[b];
    if (!evaluated.valid) {
      sum.value = std::numeric_limits<double>::infinity();
      return false;
    }
    for (int lane = 0; lane < lanes; ++lane) sum.value += evaluated.local.energy[lane];
    if (order < 1) return true;
    for (int k = 0; k < local_nodes; ++k)
      for (int i = 0; i < 2; ++i)
        for (int lane = 0; lane < lanes; ++lane)
          sum.gradient[Kernel::index(batch, coordinates_, k, i, lane)] += evaluated.local.force[k][i][lane];
    if (order < 2) return true;
    for (int lane = 0; lane < lanes; ++lane)
      Kernel::add_stiffness(batch, coordinates_, evaluated.local, lane, sum.hessian);
    return true;
  };
  numerics::add_elements<Kernel::Evaluated>(batches_.size(), batches_per_task, evaluate, add);
}

void ElasticEnergy::add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const {
  const auto evaluate = [&](std::size_t b, ElasticBatch& local) {
    Kernel::gather(batches_[b], x, local);
    integrate(law_, 2, local);
  };
  const auto add = [&](std::size_t b, const ElasticBatch& local) {
    const Batch& batch = batches_[b];
    for (int lane = 0; lane < lanes; ++lane) {
      const Kernel::Block rows = Kernel::rows(batch, lane);
      double block[Kernel::block_entries];
      for (std::size_t a = 0; a < alternations.size(); ++a) {
        double sign[6];
        for (int k = 0; k < 6; ++k)
          sign[k] = alternations[a].sign(batch.shift[k][lane].first, batch.shift[k][lane].second);
        Kernel::nodal_stiffness(batch, local, lane, sign, block);
        entries[a].add_block(rows, block);
      }
    }
    return true;
  };
  numerics::add_elements<ElasticBatch>(batches_.size(), batches_per_task, evaluate, add);
}

double ElasticEnergy::look_ahead(const CellState& from, const CellState& to, CostLedger* /*cost*/) {
  return largest_inversion_free_step(from.x, to.x - from.x);
}

double ElasticEnergy::largest_inversion_free_step(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const {
  ElasticBatch at;
  ElasticBatch along;
  double inverting_step = std::numeric_limits<double>::infinity();
  for (const Batch& batch : batches_) {
    Kernel::gather(batch, x, at);
    Kernel::gather(batch, step, along);
    inverting_step = std::min(inverting_step, first_inversion(at, along));
  }
  return max_inversion_fraction * inverting_step;
}

double ElasticEnergy::force_scale(const Eigen::VectorXd& x) const {
  ElasticBatch local;
  double sum = 0;
  for (const Batch& batch : batches_) {
    Kernel::gather(batch, x, local);
    if (!integrate(law_, 1, local)) return std::numeric_limits<double>::infinity();
    for (int k = 0; k < 6; ++k)
      for (int i = 0; i < 2; ++i)
        for (int lane = 0; lane < lanes; ++lane) sum += local.force[k][i][lane] * local.force[k][i][lane];
  }
  return std::sqrt(sum) + reference_strain * unit_forces_;
}

double ElasticEnergy::force_rounding() const { return relative_rounding * unit_forces_; }

double ElasticEnergy::smallest_jacobian(const Eigen::VectorXd& x) const {
  const Eigen::Matrix2d strain_change = coordinates_.strain_change(x);
  double smallest = std::numeric_limits<double>::infinity();
  for (const Batch& batch : batches_) {
    for (int lane = 0; lane < lanes; ++lane) {
      Eigen::Matrix<double, 2, 3> gradients;
      Eigen::Matrix<double, 2, 6> displacements;
      for (int i = 0; i < 2; ++i) {
        for (int k = 0; k < 3; ++k) gradients(i, k) = batch.gradient[k][i][lane];
        for (int k = 0; k < 6; ++k) displacements(i, k) = x[2 * batch.node[k][lane] + i];
      }
      smallest = std::min(smallest, smallest_quadratic_jacobian(gradients, displacements, strain_change));
    }
  }
  return smallest;
}

}  // namespace supple::microscale
