#pragma once

#include "elastic_network.h"
#include "element_energies.h"
#include "host_element.h"
#include "network_state.h"

namespace supple::embedded {

/// Elements on a host that keeps its shape: the lengths of paths depend on their ends alone.
class RigidHostElements {
 public:
  /// Both outlive this.
  RigidHostElements(const ElasticNetwork& network, const FoundPaths& found) : network_(network), found_(found) {}

  SpringElement spring(std::size_t i, int order) const;
  TriangleElement triangle(std::size_t t, int order) const;

 private:
  const ElasticNetwork& network_;
  const FoundPaths& found_;
};

/// Elements on a deformable host: lengths depend on the nodes of the faces that a path crosses, too. With `convex`
/// their Hessians are replaced by positive semidefinite matrices; see surface::convex_host_hessian.
class DeformableHostElements {
 public:
  /// Both outlive this. The state's lengths have derivatives up to the order that is asked for.
  DeformableHostElements(const ElasticNetwork& network, const NetworkState& state, bool convex)
      : network_(network), state_(state), convex_(convex) {}

  /// The ends of the spring are in different places.
  HostElement spring(std::size_t i, int order) const;
  HostElement triangle(std::size_t t, int order) const;

 private:
  HostLength length(std::size_t path, int order) const;

  const ElasticNetwork& network_;
  const NetworkState& state_;
  bool convex_;
};

}  // namespace supple::embedded
