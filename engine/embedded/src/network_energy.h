#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "border_contacts.h"
#include "elastic_network.h"
#include "network_state.h"
#include "path_cache.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// The energy of all elements that follow shortest paths: springs, weight (g - rest_length)^2 of the length g of one
/// path [Thesis, eq. 3.13], and the triangles of membranes, neo-Hookean functions of the lengths of three paths
/// [Thesis, eq. 3.17 to 3.20]. On a deformable host they exert forces on its nodes, too [Thesis, eq. 3.21 and 3.22].
///
/// Where E is smooth. Each smooth piece of a squared distance is convex to second order (see
/// surface::SquaredDistances). Across an edge, and where a path begins to bend at a saddle vertex, E is continuously
/// differentiable. Beside a vertex with a small excess of angle, E bends sharply within a narrow wedge behind the
/// vertex.
///
/// Where E is not smooth:
/// - At a cut locus and at a vertex of less than 2 pi, a path under tension has an energy that is the least of several
///   pieces. No minimum lies there.
/// - At a saddle or boundary vertex E is like the tip of a cone, and may have its minimum there whatever small changes
///   the others undergo. The gradient there is the steepest descent of all directions, zero at a minimum (ConeForces).
/// - A point that is pushed across an edge of the boundary rests against it, and the gradient is what is left along the
///   edge (BorderContacts).
/// - A path under compression has an energy that is the greatest of several pieces at its cut locus, one for each
///   shortest path: a valley with a kink at the bottom. A state may have paths that are kept there (CutLocus). Their
///   ends move along the valley only. The length's derivatives are then the convex combination of those of the shortest
///   paths that leaves the least gradient: E is stationary in the sense of [Clarke1983] where nothing is left, and
///   Newton's method converges as elsewhere. A path that would keep its ends there without the others is released.
///   Rigid and moving hosts only.
///
/// NetworkSearch finds the minima at such places, to which no line search leads.
class NetworkEnergy : public numerics::Term<NetworkState> {
 public:
  /// `solver` outlives the term; see PathCache.
  NetworkEnergy(const surface::GeodesicSolver& solver, std::shared_ptr<const ElasticNetwork> network,
                PathCacheOptions options);

  /// See PathCache::take_strips.
  void take_strips(const NetworkEnergy& other) { cache_.take_strips(other.cache_); }
  const ElasticNetwork& network() const { return *network_; }
  /// Divides the force of each path at a cut locus anew, for a state whose paths were found while other points were
  /// fixed. Does nothing if none are found.
  void redistribute_path_forces(NetworkState& state) const;

  std::string_view name() const override { return "geodesic_elements"; }
  /// On a deformable host: see surface::convex_host_hessian.
  bool has_convex_hessian() const override { return true; }
  void prepare(NetworkState& state, int order, const Execution& execution) override;
  void add(const NetworkState& state, int order, numerics::EnergySum& sum) const override;
  /// No point moves farther than four diagonals of the mesh, so that a point which hardly any force holds does not walk
  /// around the surface for ever.
  double largest_step(const NetworkState& state, const Eigen::VectorXd& step) const override;
  void bill(CostLedger& cost, double seconds) const override;

 private:
  /// Divides the force of each path at a cut locus among its equally short paths. All lengths are known.
  void distribute_path_forces(NetworkState& state, PathCache::Found found) const;
  /// The points that the energy pushes against the boundary.
  BorderContacts active_contacts(const NetworkState& state) const;
  /// All elements. Derivatives by points at vertices are left out, and so are those across edges with a contact.
  void add_elements(const NetworkState& state, int order, const BorderContacts& contacts,
                    numerics::EnergySum& sum) const;
  template <class Elements>
  void add_elements(const Elements& elements, const NetworkState& state, int order, const BorderContacts& contacts,
                    numerics::EnergySum& sum) const;
  void add_cut_locus_penalty(const NetworkState& state, numerics::EnergySum& sum) const;
  void add_contact_stiffness(const BorderContacts& contacts, numerics::EnergySum& sum) const;

  std::shared_ptr<const ElasticNetwork> network_;
  PathCache cache_;
  double max_step_;  ///< mesh units
};

}  // namespace supple::embedded
