#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "host_model.h"
#include "network_search.h"
#include "supple/base/random.h"
#include "supple/embedded/network_builders.h"
#include "supple/embedded/relaxation.h"
#include "supple/numerics/system.h"
#include "support/nearest_point.h"
#include "support/shapes.h"

namespace supple::embedded {

/// A network on a deformable host, and what the equilibrium of every hard case must satisfy.
class HostCase {
 public:
  HostCase(surface::TriangleMesh built, Host host) : mesh(testing::share(std::move(built))), solver(mesh) {
    options.host = std::move(host);
  }

  surface::SurfacePoint near(double x, double y, double z) const { return testing::nearest_point(*mesh, {x, y, z}); }

  /// Points with a least distance, and springs between neighbours whose rest length is a fraction of their distance.
  void cover(double spacing, double rest_share, double weight) {
    network.points = poisson_disk_points(solver, spacing, 1);
    for (const auto& [a, b] : triangulate(solver, network.points).edges) join(a, b, rest_share, weight);
    network.fixed_points = {0};
  }
  void join(std::int32_t a, std::int32_t b, double rest_share, double weight) {
    const double length =
        solver.distance(network.points[static_cast<std::size_t>(a)], network.points[static_cast<std::size_t>(b)]);
    network.springs.push_back({a, b, rest_share * length, weight});
  }
  /// The vertices for which `chosen` is true.
  template <class Chosen>
  std::vector<std::int32_t> vertices_where(const Chosen& chosen) const {
    std::vector<std::int32_t> vertices;
    for (std::int32_t i = 0; i < mesh->vertex_count(); ++i)
      if (chosen(mesh->positions()[i])) vertices.push_back(i);
    return vertices;
  }

  /// The equilibrium, after checking that it is one.
  Relaxation solve() const {
    const Relaxation relaxed = relax(solver, network, options);
    EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged) << "gradient " << relaxed.gradient_norm;
    EXPECT_LE(relaxed.gradient_norm, relaxed.gradient_tolerance);
    EXPECT_LE(relaxed.gradient_norm, 1e-6);
    check_descent(relaxed);
    check_equilibrium(relaxed);
    return relaxed;
  }

  /// Checks that the energy never increases, and that it agrees with its definition.
  void check_descent(const Relaxation& relaxed) const {
    for (std::size_t i = 1; i < relaxed.history.size(); ++i)
      EXPECT_LE(relaxed.history[i].energy, relaxed.history[i - 1].energy * (1 + 1e-12)) << "step " << i;
    double energy = relaxed.network_energy;
    for (const auto& term : relaxed.host.terms) energy += term.energy;
    EXPECT_NEAR(relaxed.energy, energy, 1e-10 * std::abs(energy));
    const surface::GeodesicSolver moved(testing::share(mesh->with_positions(relaxed.host.vertices)));
    const auto at = [&](std::int32_t point) { return relaxed.points[static_cast<std::size_t>(point)]; };
    double springs = 0;
    for (const Spring& s : network.springs)
      springs += s.weight * std::pow(moved.distance(at(s.from), at(s.to)) - s.rest_length, 2);
    if (network.triangles.empty()) {
      EXPECT_NEAR(relaxed.network_energy, springs, 1e-9 * springs + 1e-18);
    }
  }

  /// Checks the equilibrium with terms built anew: there is no force on free coordinates, nor one that rigid-body
  /// constraints would have to take; all forces and moments, those at fixed nodes included, sum to zero; and no step in
  /// 8 random directions lowers the energy.
  void check_equilibrium(const Relaxation& relaxed) const {
    Eigen::VectorXd nodes(3 * static_cast<Eigen::Index>(relaxed.host.vertices.size() + relaxed.host.inside.size()));
    Eigen::Index row = 0;
    for (const auto* part : {&relaxed.host.vertices, &relaxed.host.inside})
      for (const Eigen::Vector3d& node : *part) {
        nodes.segment<3>(row) = node;
        row += 3;
      }
    const NetworkState state(
        std::make_shared<surface::GeodesicSolver>(testing::share(mesh->with_positions(relaxed.host.vertices))),
        relaxed.points, nodes);
    const HostModel model(*mesh, options.host, {});
    numerics::System<NetworkState>::Terms terms = model.terms();
    std::vector<bool> held_points(network.points.size(), false);
    for (const std::int32_t point : network.fixed_points) held_points[static_cast<std::size_t>(point)] = true;
    terms.push_back(network_term(solver, network, held_points).energy);
    numerics::System<NetworkState> system(state, terms, numerics::Unknowns(state.dimension()));
    const Eigen::VectorXd forces = system.full_gradient();

    double scale = 0;  // magnitude of the forces that cancel each other
    for (const auto& term : terms) {
      numerics::EnergySum own;
      own.clear(state.dimension(), 1);
      term->add(system.state(), 1, own);
      scale += own.gradient.norm();
    }
    const double rounding = 1e-11 * scale + 1e-14;
    const double slack = 2 * relaxed.gradient_norm + rounding;
    std::vector<bool> fixed(static_cast<std::size_t>(mesh->vertex_count()), false);
    std::visit(
        [&](const auto& host) {
          if constexpr (requires { host.fixed_vertices; })
            for (const std::int32_t vertex : host.fixed_vertices) fixed[static_cast<std::size_t>(vertex)] = true;
          if constexpr (requires { host.moved_vertices; })
            for (const MovedVertex& one : host.moved_vertices) fixed[static_cast<std::size_t>(one.vertex)] = true;
        },
        options.host);
    Eigen::VectorXd unheld = forces;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < network.points.size(); ++i)
      if (held_points[i]) unheld.segment<2>(2 * static_cast<Eigen::Index>(i)).setZero();
    for (std::int32_t i = 0; i < state.nodes().size() / 3; ++i) {
      const Eigen::Vector3d own = forces.segment<3>(state.node_row(i));
      force += own;
      moment += state.node(i).cross(own);
      if (i < mesh->vertex_count() && fixed[static_cast<std::size_t>(i)])
        unheld.segment<3>(state.node_row(i)).setZero();
    }
    // A rigid-body constraint takes the residual of all other forces, multiplied by their lever arms.
    EXPECT_LE(unheld.norm(), slack * (model.rigid_body_constraints() > 0 ? 10 * std::sqrt(forces.size()) : 1));
    if (!carries_weight()) {
      EXPECT_LE(force.norm(), 10 * rounding);
      EXPECT_LE(moment.norm(), 100 * rounding * mesh->diagonal());
    }

    RandomStream random("beside_a_rest", 1);
    const double energy = system.energy();
    for (int direction = 0; direction < 8; ++direction) {
      Eigen::VectorXd step(state.dimension());
      for (double& entry : step) entry = random.normal();
      for (Eigen::Index i = 0; i < step.size(); ++i)
        if (unheld[i] == 0) step[i] = 0;
      step *= 1e-5 * mesh->mean_edge_length() / step.norm();
      NetworkState beside = system.state();
      beside.move(step);
      numerics::System<NetworkState> there(beside, terms, numerics::Unknowns(state.dimension()));
      EXPECT_GE(there.evaluate(0).value, energy - unheld.norm() * step.norm() - 1e-12 * std::abs(energy))
          << "direction " << direction;
    }
  }

  std::shared_ptr<const surface::TriangleMesh> mesh;
  surface::GeodesicSolver solver;
  Network network;
  RelaxationOptions options;

 private:
  bool carries_weight() const {
    const auto* solid = std::get_if<SolidHost>(&options.host);
    return solid && !solid->gravity.isZero(0);
  }
};

}  // namespace supple::embedded
