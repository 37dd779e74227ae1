#include "solid_elements.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "first_inversion.h"
#include "supple/base/cost_ledger.h"
#include "supple/numerics/element_loop.h"
#include "x_minus_log1p.h"

namespace supple::embedded {
namespace {

/// Fraction of the step to the first inversion that may be taken.
constexpr double inversion_safety = 0.9;

/// Elements that one task of the parallel loop evaluates.
constexpr std::size_t tetrahedra_per_task = 128;

/// Squared norm of Green's strain up to which the energy is computed from invariants of the strain alone.
constexpr double max_small_strain = 1.0 / 16;

Eigen::VectorXd coordinates_of(const std::vector<Eigen::Vector3d>& nodes) {
  Eigen::VectorXd coordinates(3 * static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) coordinates.segment<3>(3 * static_cast<Eigen::Index>(i)) = nodes[i];
  return coordinates;
}

/// The columns are the edges from node 0 to the other three.
Eigen::Matrix3d edges_of(const std::array<std::int32_t, 4>& nodes, const auto& coordinates) {
  const auto at = [&](std::int32_t node) {
    return Eigen::Vector3d(coordinates.template segment<3>(3 * static_cast<Eigen::Index>(node)));
  };
  const Eigen::Vector3d first = at(nodes[0]);
  Eigen::Matrix3d edges;
  edges << at(nodes[1]) - first, at(nodes[2]) - first, at(nodes[3]) - first;
  return edges;
}

/// The matrix of cofactors, det A A^-T.
Eigen::Matrix3d cofactors_of(const Eigen::Matrix3d& a) {
  Eigen::Matrix3d cofactors;
  cofactors << a.col(1).cross(a.col(2)), a.col(2).cross(a.col(0)), a.col(0).cross(a.col(1));
  return cofactors;
}

double youngs_modulus_at(const Eigen::Vector3d& center, const SolidHost& solid) {
  double modulus = solid.youngs_modulus;
  for (const SolidRegion& region : solid.regions)
    if ((center.array() >= region.lower.array()).all() && (center.array() <= region.upper.array()).all())
      modulus = region.youngs_modulus;
  return modulus;
}

/// The energy density of an element and its derivatives by F = 1 + the displacement gradient.
struct NeoHookean {
  double value = std::numeric_limits<double>::infinity();
  Eigen::Matrix3d inverse_transpose;  ///< F^-T
  Eigen::Matrix3d stress;             ///< first Piola-Kirchhoff
  double log_j = 0;

  NeoHookean(const Eigen::Matrix3d& displacement_gradient, double mu, double lambda) {
    const Eigen::Matrix3d& h = displacement_gradient;
    const Eigen::Matrix3d f = Eigen::Matrix3d::Identity() + h;
    const Eigen::Matrix3d cofactors = cofactors_of(f);
    const double j = f.col(0).dot(cofactors.col(0));
    if (!(j > 0)) return;
    const Eigen::Matrix3d strain = 0.5 * (h + h.transpose() + h.transpose() * h);
    const double trace = strain.trace();
    const double square = strain.squaredNorm();
    if (square <= max_small_strain) {
      // tr C - 3 = 2 tr G and J^2 - 1 = 2 tr G + q, with Green's strain G. First-order terms, which would cancel, drop
      // out: psi = mu / 2 (J^2 - 1 - log J^2 - q) + lambda / 2 log(J)^2.
      const double q = 2 * (trace * trace - square) + 8 * strain.determinant();
      const double growth = 2 * trace + q;
      log_j = 0.5 * std::log1p(growth);
      value = 0.5 * mu * (x_minus_log1p(growth) - q);
    } else {
      log_j = std::log(j);
      value = mu * (trace - log_j);
    }
    value += 0.5 * lambda * log_j * log_j;
    inverse_transpose = cofactors / j;
    // The stress is mu (F - F^-T) + lambda log J F^-T, in which F - F^-T = F^-T (C - 1).
    Eigen::Matrix3d mandel_stress = 2 * mu * strain;
    mandel_stress.diagonal().array() += lambda * log_j;
    stress.noalias() = inverse_transpose * mandel_stress;
  }
};

/// Calls visit(eigenvalue, mode) for the eigenvectors of unit norm, with a negative eigenvalue, of the energy density's
/// Hessian by F.
///
/// With F = U S V^T and k = mu - lambda log J, two eigenvectors for each pair of principal axes are
/// (u_i v_j^T -+ u_j v_i^T) / sqrt(2), with the eigenvalues mu -+ k / (s_i s_j). The other three stretch the axes.
template <class Visit>
void for_each_negative_mode(const Eigen::Matrix3d& f, double mu, double lambda, double log_j, const Visit& visit) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(f.transpose() * f);
  const Eigen::Vector3d inverse = principal.eigenvalues().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d& v = principal.eigenvectors();
  const Eigen::Matrix3d u = f * v * inverse.asDiagonal();
  const double k = mu - lambda * log_j;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Eigen::Matrix3d one = u.col(i) * v.col(j).transpose();
    const Eigen::Matrix3d other = u.col(j) * v.col(i).transpose();
    for (const double sign : {-1.0, 1.0}) {
      const double eigenvalue = mu + sign * k * inverse[i] * inverse[j];
      if (eigenvalue < 0) visit(eigenvalue, std::numbers::sqrt2 / 2 * (one + sign * other));
    }
  }
  Eigen::Matrix3d stretches = lambda * inverse * inverse.transpose();
  for (int i = 0; i < 3; ++i) stretches(i, i) += mu + k * inverse[i] * inverse[i];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(stretches);
  for (int i = 0; i < 3 && modes.eigenvalues()[i] < 0; ++i)
    visit(modes.eigenvalues()[i], u * modes.eigenvectors().col(i).asDiagonal() * v.transpose());
}

}  // namespace

struct SolidElements::Evaluated {
  static constexpr int size = 12;
  double value;
  double gradient[size];
  double lower[numerics::HessianEntries::entries_of(size)];
};

SolidElements::SolidElements(const meshing::TetrahedralMesh& rest, const SolidHost& solid)
    : rest_(coordinates_of(rest.nodes)) {
  elements_.reserve(rest.tetrahedra.size());
  for (const meshing::Tetrahedron& nodes : rest.tetrahedra) {
    Element element;
    element.nodes = nodes;
    const Eigen::Matrix3d edges = edges_of(nodes, rest_);
    const double determinant = edges.determinant();
    if (!(determinant > 0)) throw std::invalid_argument("a tetrahedron of the solid has no volume");
    element.volume = determinant / 6;
    element.gradients = cofactors_of(edges) / determinant;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (const std::int32_t node : nodes) center += rest.nodes[static_cast<std::size_t>(node)] / 4;
    const double modulus = youngs_modulus_at(center, solid);
    const double nu = solid.poisson_ratio;
    element.mu = modulus / (2 * (1 + nu));
    element.lambda = modulus * nu / ((1 + nu) * (1 - 2 * nu));
    elements_.push_back(element);
  }
}

// Differences of displacements are exact enough for small strains; differences of positions would cancel.
Eigen::Matrix3d SolidElements::displacement_gradient(const Element& element, const NetworkState& state) const {
  const auto displacement = [&](std::int32_t node) -> Eigen::Vector3d {
    return state.nodes().segment<3>(3 * static_cast<Eigen::Index>(node)) -
           rest_.segment<3>(3 * static_cast<Eigen::Index>(node));
  };
  const Eigen::Vector3d first = displacement(element.nodes[0]);
  Eigen::Matrix3d changes;
  changes << displacement(element.nodes[1]) - first, displacement(element.nodes[2]) - first,
      displacement(element.nodes[3]) - first;
  return changes * element.gradients.transpose();
}

void SolidElements::evaluate(const Element& element, const NetworkState& state, int order, bool convex,
                             Evaluated& to) const {
  const Eigen::Matrix3d displacements = displacement_gradient(element, state);
  const NeoHookean law(displacements, element.mu, element.lambda);
  to.value = element.volume * law.value;
  if (order < 1 || !std::isfinite(law.value)) return;
  Eigen::Map<Eigen::Matrix<double, 3, 4>> gradient(to.gradient);
  gradient.rightCols<3>().noalias() = element.volume * law.stress * element.gradients;
  gradient.col(0) = -gradient.rightCols<3>().rowwise().sum();
  if (order < 2) return;
  // b are the gradients of the barycentric coordinates by the position at rest, and c = F^-T b those by the position
  // now. The block of nodes k and l is V (mu (b_k.b_l) 1 + (mu - lambda log J) c_l c_k^T + lambda c_k c_l^T).
  Eigen::Matrix<double, 3, 4> b;
  b.rightCols<3>() = element.gradients;
  b.col(0) = -element.gradients.rowwise().sum();
  const Eigen::Matrix<double, 3, 4> c = law.inverse_transpose * b;
  const double outer_factor = element.volume * element.lambda;
  const double transposed_factor = element.volume * (element.mu - element.lambda * law.log_j);
  double* entry = to.lower;
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 3; ++i)
      for (int l = 0; l <= k; ++l) {
        const double same = element.volume * element.mu * b.col(k).dot(b.col(l));
        for (int j = 0; j < (l == k ? i + 1 : 3); ++j)
          *entry++ = (i == j ? same : 0) + outer_factor * c(i, k) * c(j, l) + transposed_factor * c(i, l) * c(j, k);
      }
  if (!convex) return;
  const auto subtract_mode = [&](double eigenvalue, const Eigen::Matrix3d& mode) {
    const Eigen::Matrix<double, 3, 4> direction = mode * b;
    double* lower = to.lower;
    for (int k = 0; k < 12; ++k)
      for (int l = 0; l <= k; ++l)
        *lower++ -= element.volume * eigenvalue * direction(k % 3, k / 3) * direction(l % 3, l / 3);
  };
  for_each_negative_mode(Eigen::Matrix3d::Identity() + displacements, element.mu, element.lambda, law.log_j,
                         subtract_mode);
}

void SolidElements::add(const NetworkState& state, int order, numerics::EnergySum& sum) const {
  const auto evaluate_one = [&](std::size_t e, Evaluated& to) { evaluate(elements_[e], state, order, sum.convex, to); };
  const auto add_one = [&](std::size_t e, const Evaluated& from) {
    if (!std::isfinite(from.value)) {
      sum.value = std::numeric_limits<double>::infinity();
      return false;
    }
    std::array<std::int32_t, Evaluated::size> rows;
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < 3; ++i)
        rows[3 * k + i] = state.node_row(elements_[e].nodes[k]) + static_cast<std::int32_t>(i);
    sum.add_element(rows, order, from.value, from.gradient, from.lower);
    return true;
  };
  numerics::add_elements<Evaluated>(elements_.size(), tetrahedra_per_task, evaluate_one, add_one);
}

double SolidElements::largest_step(const NetworkState& state, const Eigen::VectorXd& step) const {
  const auto changes = step.tail(state.nodes().size());
  double first = std::numeric_limits<double>::infinity();
  for (const Element& element : elements_)
    first = std::min(first,
                     first_inversion(edges_of(element.nodes, state.nodes()), edges_of(element.nodes, changes), first));
  return inversion_safety * first;
}

void SolidElements::bill(CostLedger& cost, double seconds) const {
  cost.add_stage("assembly", seconds);
  cost.add_effect(name(), true, "the surface is that of an elastic solid", 1, seconds);
}

double SolidElements::volume(const NetworkState& state) const {
  double volume = 0;
  for (const Element& element : elements_) volume += edges_of(element.nodes, state.nodes()).determinant() / 6;
  return volume;
}

double SolidElements::least_volume_ratio(const NetworkState& state) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Element& element : elements_)
    least = std::min(least, edges_of(element.nodes, state.nodes()).determinant() / (6 * element.volume));
  return least;
}

Gravity::Gravity(const meshing::TetrahedralMesh& rest, const Eigen::Vector3d& force)
    : rest_(coordinates_of(rest.nodes)), weights_(rest.nodes.size(), 0), force_(force) {
  for (const meshing::Tetrahedron& nodes : rest.tetrahedra)
    for (const std::int32_t node : nodes)
      weights_[static_cast<std::size_t>(node)] += edges_of(nodes, rest_).determinant() / 24;
}

void Gravity::add(const NetworkState& state, int order, numerics::EnergySum& sum) const {
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const auto at = 3 * static_cast<Eigen::Index>(i);
    const Eigen::Vector3d weight = weights_[i] * force_;
    sum.value -= weight.dot(state.nodes().segment<3>(at) - rest_.segment<3>(at));
    if (order >= 1) sum.gradient.segment<3>(state.node_row(static_cast<std::int32_t>(i))) -= weight;
  }
}

void Gravity::bill(CostLedger& cost, double seconds) const {
  cost.add_stage("assembly", seconds);
  cost.add_effect(name(), true, "the solid has a weight", 1, seconds);
}

}  // namespace supple::embedded
