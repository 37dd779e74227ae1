#include "elastic_energy.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "elastic_kernel.h"
#include "jacobian_bounds.h"

namespace supple::microscale {
namespace {

/// Share of the way to an inverted integration point that a step may go: the energy is finite but already steep there.
constexpr double inversion_safety = 0.9;

/// Strain whose forces count as none.
constexpr double strain_at_rest = 1e-6;
/// Rounding errors of the gradient, relative to forces of a strain of one: deformation gradients are rounded near 1.
constexpr double relative_rounding = 16 * std::numeric_limits<double>::epsilon();

}  // namespace

/// The two ways in which a batch's local degrees of freedom enter the patch: the six nodes, then the two columns of F,
/// which act like nodes whose shape functions are the coordinates themselves.
struct ElasticEnergy::Kernel {
  /// Degree of freedom of component i of local node k in one lane.
  static Eigen::Index index(const Batch& batch, const CellCoordinates& coordinates, int k, int i, int lane) {
    if (k < 6) return coordinates.displacement(batch.node[k][lane]) + i;
    return coordinates.strain() + 2 * i + (k - 6);
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

void ElasticEnergy::add(const Eigen::VectorXd& x, int order, numerics::EnergySum& sum) const {
  ElasticBatch local;
  for (const Batch& batch : batches_) {
    Kernel::gather(batch, x, local);
    if (!integrate(law_, order, local)) {
      sum.value = std::numeric_limits<double>::infinity();
      return;
    }
    for (int lane = 0; lane < lanes; ++lane) sum.value += local.energy[lane];
    if (order < 1) continue;
    for (int k = 0; k < local_nodes; ++k)
      for (int i = 0; i < 2; ++i)
        for (int lane = 0; lane < lanes; ++lane)
          sum.gradient[Kernel::index(batch, coordinates_, k, i, lane)] += local.force[k][i][lane];
    if (order < 2) continue;
    for (int lane = 0; lane < lanes; ++lane) {
      Eigen::Index dof[local_nodes][2];
      for (int k = 0; k < local_nodes; ++k)
        for (int i = 0; i < 2; ++i) dof[k][i] = Kernel::index(batch, coordinates_, k, i, lane);
      for (int k = 0, pair = 0; k < local_nodes; ++k) {
        for (int l = 0; l < k; ++l, ++pair)
          for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) {
              // On a patch of very few triangles two of a triangle's nodes can be one: both orders of the pair then
              // fall on one place of the diagonal.
              const double both = dof[k][i] == dof[l][j] ? 2 : 1;
              sum.hessian.add(dof[k][i], dof[l][j], both * local.stiffness[pair][i][j][lane]);
            }
        sum.hessian.add(dof[k][0], dof[k][0], local.stiffness[pair][0][0][lane]);
        sum.hessian.add(dof[k][1], dof[k][0], local.stiffness[pair][1][0][lane]);
        sum.hessian.add(dof[k][1], dof[k][1], local.stiffness[pair][1][1][lane]);
        ++pair;
      }
    }
  }
}

void ElasticEnergy::add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const {
  ElasticBatch local;
  for (const Batch& batch : batches_) {
    Kernel::gather(batch, x, local);
    integrate(law_, 2, local);
    for (int lane = 0; lane < lanes; ++lane) {
      double sign[6][alternations.size()];
      for (int k = 0; k < 6; ++k)
        for (std::size_t a = 0; a < alternations.size(); ++a)
          sign[k][a] = alternations[a].sign(batch.shift[k][lane].first, batch.shift[k][lane].second);
      for (int k = 0, pair = 0; k < 6; ++k)
        for (int l = 0; l <= k; ++l, ++pair)
          for (int i = 0; i < 2; ++i)
            for (int j = 0; j < (l == k ? i + 1 : 2); ++j) {
              const Eigen::Index row = Kernel::index(batch, coordinates_, k, i, lane);
              const Eigen::Index column = Kernel::index(batch, coordinates_, l, j, lane);
              const double both = row == column && l != k ? 2 : 1;
              const double value = both * local.stiffness[pair][i][j][lane];
              for (std::size_t a = 0; a < alternations.size(); ++a)
                entries[a].add(row, column, sign[k][a] * sign[l][a] * value);
            }
    }
  }
}

double ElasticEnergy::largest_step(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const {
  ElasticBatch at;
  ElasticBatch along;
  double largest = std::numeric_limits<double>::infinity();
  for (const Batch& batch : batches_) {
    Kernel::gather(batch, x, at);
    Kernel::gather(batch, step, along);
    largest = std::min(largest, first_inversion(at, along));
  }
  return inversion_safety * largest;
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
  return std::sqrt(sum) + strain_at_rest * unit_forces_;
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
