#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "geodesic_elements.h"
#include "network_state.h"
#include "point_damping.h"
#include "supple/embedded/host.h"
#include "supple/numerics/equilibrium_path.h"
#include "supple/numerics/system.h"

namespace supple::embedded {

/// A network on a surface that moves, as numerics::EquilibriumPath follows it. The load is where the surface is on its
/// way: k at the k-th of its positions, 0 at the mesh.
class MovingNetwork {
 public:
  /// Where the points are and where the surface is.
  struct State {
    std::vector<surface::SurfacePoint> points;
    double load = 0;
    std::vector<CutLocus> cut_loci{};
  };

  /// `solver` is that of the mesh; references outlive this. Throws "host.positions".
  MovingNetwork(const surface::GeodesicSolver& solver, const Network& network, std::vector<bool> held_points,
                std::shared_ptr<PointDamping> damping, GeodesicElementsOptions options, const MovingHost& host,
                double gradient_tolerance, Execution execution);

  /// Moves the surface to a load, the points with it.
  void place(double load, const std::vector<surface::SurfacePoint>& points, std::vector<CutLocus> cut_loci = {});
  /// The load that steps go to from now on.
  void announce(double load) { announced_ = load; }
  double load() const { return load_; }
  const NetworkState& network_state() { return system_->state(); }
  /// The surface as it is at the present load.
  const std::shared_ptr<const surface::GeodesicSolver>& shared_solver() const { return solver_; }
  numerics::System<NetworkState>& system() { return *system_; }
  const std::shared_ptr<GeodesicElements>& elements() const { return elements_; }

  // What numerics::PathScene asks for.
  numerics::Objective& objective() { return *system_; }
  numerics::ShiftedCholesky& cholesky() { return cholesky_; }
  State state() const {
    const NetworkState& now = std::as_const(*system_).state();
    return {now.points(), load_, now.cut_loci()};
  }
  void set_state(const State& state) { place(state.load, state.points, state.cut_loci); }
  double gradient_tolerance() const { return gradient_tolerance_; }
  bool unsettled(const numerics::MinimizerResult&) { return false; }
  bool finish(const numerics::MinimizerResult&) { return true; }
  bool finish_unstable() { return true; }
  void begin_step();
  bool predict(double share);
  void arrived(const numerics::Arrival&) {}
  Eigen::VectorXd unit_mode(const Eigen::VectorXd& mode) const { return mode; }
  Eigen::VectorXd expand(const Eigen::VectorXd& mode) const { return system_->expand(mode); }
  bool move_along(const State&, const Eigen::VectorXd&, double) { return false; }
  void left_branch() {}

  /// Whether the energy of the equilibrium that was found after the last prediction differs from what the Hessian at
  /// the start of the load step predicts. If not, it is the same equilibrium.
  bool is_doubtful(double energy) const;
  /// Moves the surface back to where it was at the start of the load step and relaxes from the present equilibrium.
  /// Returns the share of the energy by which the result differs from the equilibrium that was there. Where it differs,
  /// an equilibrium was lost on the way. The present state stays. Costs a minimization.
  double loss_on_way_back(const numerics::MinimizerOptions& options);

 private:
  Eigen::VectorXd nodes_at(double load) const;
  double energy_rounding() const;
  std::shared_ptr<const surface::GeodesicSolver> surface_at(double load) const;

  const surface::GeodesicSolver& first_;
  const Network& network_;
  std::vector<bool> held_points_;
  numerics::Unknowns unknowns_;
  std::shared_ptr<PointDamping> damping_;
  GeodesicElementsOptions options_;
  std::vector<Eigen::VectorXd> stops_;  ///< coordinates of the vertices: of the mesh, then of each position
  double gradient_tolerance_;
  Execution execution_;
  double load_ = 0;
  double announced_ = 0;
  std::shared_ptr<const surface::GeodesicSolver> solver_;
  std::shared_ptr<GeodesicElements> elements_;
  std::shared_ptr<numerics::EnergySum> sums_;
  std::unique_ptr<numerics::System<NetworkState>> system_;
  numerics::ShiftedCholesky cholesky_;
  State start_;               ///< of the load step
  Eigen::VectorXd tangent_;   ///< of the points' coordinates there, for all of the announced change
  bool has_factors_ = false;  ///< whether `cholesky_` has those of the Hessian there
  double start_energy_ = 0;
  double carried_energy_ = 0;      ///< where the load step ends, with the points carried along by the surface
  double predicted_decrease_ = 0;  ///< of the energy from there, by the Hessian at the start
};

}  // namespace supple::embedded
