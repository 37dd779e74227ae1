#include "network_energy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "cone_vertices.h"
#include "cut_loci.h"
#include "length_elements.h"

namespace supple::embedded {
namespace {

/// Longest step of a point, in diagonals of the mesh.
constexpr double max_step_in_diagonals = 4;
/// Stiffness of points across a cut locus, over their own stiffness. A Newton step then leaves the cut locus by no more
/// than rounding and its curvature, and factorizations keep the digits that they need.
constexpr double cut_locus_penalty = 1e4;

}  // namespace

NetworkEnergy::NetworkEnergy(const surface::GeodesicSolver& solver, std::shared_ptr<const ElasticNetwork> network,
                             PathCacheOptions options)
    : network_(std::move(network)),
      cache_(solver, network_, options),
      max_step_(max_step_in_diagonals * solver.mesh().diagonal()) {}

void NetworkEnergy::prepare(NetworkState& state, int order, const Execution& execution) {
  if (state.collapsed()) return;
  if (!state.found()) {
    PathCache::Found found = cache_.find(state, execution);
    if (!found.equal.empty()) distribute_path_forces(state, std::move(found));
  }
  if (order >= 1 && state.surface() && !(state.host_lengths() && state.host_lengths()->order >= order))
    cache_.find_host_lengths(state, order, execution);
}

void NetworkEnergy::redistribute_path_forces(NetworkState& state) const {
  if (!state.found() || state.found()->equal.empty()) return;
  const auto paths = std::make_shared<FoundPaths>(*state.found());
  state.set_found(paths);
  PathCache::Found found;
  found.paths = paths;
  found.equal.swap(paths->equal);
  distribute_path_forces(state, std::move(found));
}

void NetworkEnergy::distribute_path_forces(NetworkState& state, PathCache::Found found) const {
  // First all of the force is in the first of the equally short paths.
  for (EqualPaths& equal : found.equal) found.paths->geodesics[equal.path] = equal.geodesics.front();
  numerics::EnergySum sum;
  sum.clear(state.dimension(), 1);
  add_elements(RigidHostElements(*network_, *found.paths), state, 1, {}, sum);
  if (!std::isfinite(sum.value)) return;
  const std::vector<double> forces = network_->path_forces(*found.paths);
  drop_uncompressed(state, found.equal, forces);
  if (found.equal.empty()) return;
  embedded::distribute_path_forces(state, found.equal, sum.gradient, forces, network_->fixed());
  found.paths->equal = std::move(found.equal);
}

double NetworkEnergy::largest_step(const NetworkState& /*state*/, const Eigen::VectorXd& step) const {
  double longest = 0;
  for (const std::size_t point : network_->free_points())
    longest = std::max(longest, step.segment<2>(2 * static_cast<Eigen::Index>(point)).squaredNorm());
  return longest > max_step_ * max_step_ ? max_step_ / std::sqrt(longest) : std::numeric_limits<double>::infinity();
}

void NetworkEnergy::add(const NetworkState& state, int order, numerics::EnergySum& sum) const {
  if (state.collapsed()) {
    sum.value = std::numeric_limits<double>::infinity();
    return;
  }
  const BorderContacts contacts = order >= 1 ? active_contacts(state) : BorderContacts();
  add_elements(state, order, contacts, sum);
  if (order < 1 || !std::isfinite(sum.value)) return;
  for (const std::size_t point : network_->free_points())
    if (state.on_tip(point)) add_cone_vertex(*network_, state, point, order, sum);
  if (order < 2) return;
  add_cut_locus_penalty(state, sum);
  add_contact_stiffness(contacts, sum);
}

BorderContacts NetworkEnergy::active_contacts(const NetworkState& state) const {
  BorderContacts contacts(*network_, state);
  if (contacts.empty()) return contacts;
  numerics::EnergySum unconstrained;
  unconstrained.clear(state.dimension(), 1);
  add_elements(state, 1, {}, unconstrained);
  if (!std::isfinite(unconstrained.value)) return {};
  contacts.keep_pushed(unconstrained.gradient);
  return contacts;
}

void NetworkEnergy::add_elements(const NetworkState& state, int order, const BorderContacts& contacts,
                                 numerics::EnergySum& sum) const {
  if (state.surface()) {
    add_elements(DeformableHostElements(*network_, state, sum.convex), state, order, contacts, sum);
  } else {
    add_elements(RigidHostElements(*network_, *state.found()), state, order, contacts, sum);
  }
}

template <class Elements>
void NetworkEnergy::add_elements(const Elements& elements, const NetworkState& state, int order,
                                 const BorderContacts& contacts, numerics::EnergySum& sum) const {
  const auto add = [&](auto element, std::span<const std::int32_t> points) {
    for (const std::int32_t point : points) {
      if (order < 1) break;
      if (state.on_tip(static_cast<std::size_t>(point))) element.zero_point(point);
      if (const BorderContact* contact = contacts.of(point)) element.project_out(point, contact->outward);
    }
    element.add_to(sum, order);
  };
  const std::vector<Spring>& springs = network_->springs();
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const surface::TangentGeodesic& geodesic = state.found()->geodesics[i];
    if (geodesic.coincident()) {
      // Ends in one place of the surface stay together however the host moves, and their energy is differentiable also
      // at a vertex.
      spring_element_at_zero(springs[i], geodesic.turn, i).add_to(sum, order);
      continue;
    }
    const std::array<std::int32_t, 2> ends{springs[i].from, springs[i].to};
    add(elements.spring(i, order), ends);
  }
  for (std::size_t t = 0; t < network_->triangles().size(); ++t) {
    auto element = elements.triangle(t, order);
    if (!std::isfinite(element.value)) {
      sum.value = element.value;
      return;
    }
    add(std::move(element), network_->triangles()[t].given.corners);
  }
}

void NetworkEnergy::add_cut_locus_penalty(const NetworkState& state, numerics::EnergySum& sum) const {
  for (const EqualPaths& equal : state.found()->equal) {
    const auto [from, to] = network_->paths()[equal.path];
    const double stiffness = cut_locus_penalty * (network_->stiffness_at(static_cast<std::size_t>(from)) +
                                                  network_->stiffness_at(static_cast<std::size_t>(to)));
    SpringElement element({from, to});
    for (const Eigen::Vector4d& across : equal.across) element.hessian += stiffness * across * across.transpose();
    element.add_to(sum, 2);
  }
}

void NetworkEnergy::add_contact_stiffness(const BorderContacts& contacts, numerics::EnergySum& sum) const {
  for (const BorderContact& contact : contacts.all()) {
    // The gradient has no part along `outward`, so any positive stiffness keeps the point in its place.
    const double stiffness = network_->stiffness_at(static_cast<std::size_t>(contact.point));
    for (int k = 0; k < 2; ++k)
      for (int l = 0; l <= k; ++l)
        sum.hessian.add(2 * contact.point + k, 2 * contact.point + l,
                        stiffness * contact.outward[k] * contact.outward[l]);
  }
}

void NetworkEnergy::bill(CostLedger& cost, double seconds) const {
  cost.add_stage("assembly", seconds);
  const auto springs = static_cast<double>(network_->springs().size());
  const auto triangles = static_cast<double>(network_->triangles().size());
  const double all = springs + triangles;
  if (springs > 0 || triangles == 0)
    cost.add_effect("geodesic_springs", true, "the springs follow shortest paths on the surface", 1,
                    all > 0 ? seconds * springs / all : seconds);
  if (triangles > 0)
    cost.add_effect("membrane", true, "there are triangles, whose sides are shortest paths", 1,
                    seconds * triangles / all);
}

}  // namespace supple::embedded
