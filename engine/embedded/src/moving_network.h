#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "elastic_network.h"
#include "network_search.h"
#include "network_state.h"
#include "point_damping.h"
#include "supple/embedded/host.h"
#include "supple/numerics/equilibrium_path.h"
#include "supple/numerics/system.h"

namespace supple::embedded {

/// A network on a surface that moves, as a scene for numerics::EquilibriumPath. The load says how far the surface has
/// moved: k at the k-th of its positions, 0 at the mesh.
class MovingNetwork {
 public:
  struct State {
    std::vector<surface::SurfacePoint> points;
    double load = 0;
    std::vector<CutLocus> cut_loci{};
  };

  /// `solver` is that of the mesh and outlives this; `start` has the load 0. Throws "host.positions".
  MovingNetwork(const surface::GeodesicSolver& solver, std::shared_ptr<const ElasticNetwork> network,
                std::shared_ptr<PointDamping> damping, PathCacheOptions options, const MovingHost& host,
                const State& start, double gradient_tolerance, Execution execution);

  /// Moves the surface to a load and puts the points at these barycentric coordinates.
  void place(double load, const std::vector<surface::SurfacePoint>& points, std::vector<CutLocus> cut_loci = {});
  /// Sets the load to which steps go from now on.
  void set_target(double load) { target_ = load; }
  double load() const { return load_; }
  /// The present state with its paths.
  const NetworkState& prepared_state() { return system_->prepared_state(); }
  /// The solver of the surface at the present load.
  const std::shared_ptr<const surface::GeodesicSolver>& solver() const { return solver_; }
  numerics::System<NetworkState>& system() { return *system_; }

  // The interface of numerics::PathScene:
  numerics::Objective& objective() { return *system_; }
  numerics::ShiftedCholesky& cholesky() { return cholesky_; }
  State state() const {
    const NetworkState& now = std::as_const(*system_).state();
    return {now.points(), load_, now.cut_loci()};
  }
  void set_state(const State& state) { place(state.load, state.points, state.cut_loci); }
  double gradient_tolerance() const { return gradient_tolerance_; }
  bool must_minimize_again(const numerics::MinimizerResult&) { return false; }
  bool finish(const numerics::MinimizerResult&) { return true; }
  bool finish_unstable() { return true; }
  void begin_step();
  bool predict(double fraction);
  void finish_load_step(const numerics::LoadStepResult&) {}
  Eigen::VectorXd unit_mode(const Eigen::VectorXd& mode) const { return mode; }
  Eigen::VectorXd expand(const Eigen::VectorXd& mode) const { return system_->expand(mode); }
  bool move_along(const State&, const Eigen::VectorXd&, double) { return false; }
  void left_branch() {}

  /// Whether the energy of the equilibrium that was found from the last prediction differs from what the Hessian at the
  /// start of the load increment predicts. Otherwise it is the continuation of the equilibrium at the start.
  bool is_doubtful(double energy) const;
  /// Moves the surface back to the start of the load increment and minimizes from the present equilibrium. Returns how
  /// much the energy differs from that at the start, relative to the larger of the energies at both ends: if it is not
  /// zero, an equilibrium was lost in the increment. The present state stays. Costs a minimization.
  double loss_on_return(const numerics::MinimizerOptions& options);

 private:
  Eigen::VectorXd nodes_at(double load) const;
  std::shared_ptr<const surface::GeodesicSolver> surface_at(double load) const;
  /// Adds to `unbalanced` the gradient after this fraction of the load increment, in which points keep their
  /// barycentric coordinates; `own_change` becomes the step that moves ends of paths back to their cut loci. False
  /// where the energy is not finite.
  bool add_gradient_change(double fraction, Eigen::VectorXd& unbalanced, Eigen::VectorXd& own_change) const;
  double energy_rounding() const;

  const surface::GeodesicSolver& first_solver_;
  std::shared_ptr<const ElasticNetwork> network_;
  numerics::Unknowns unknowns_;
  std::shared_ptr<PointDamping> damping_;
  PathCacheOptions options_;
  std::vector<Eigen::VectorXd> positions_;  ///< coordinates of the vertices: of the mesh, then at each position
  double gradient_tolerance_;
  Execution execution_;
  double load_ = 0;
  double target_ = 0;
  std::shared_ptr<const surface::GeodesicSolver> solver_;
  std::shared_ptr<NetworkEnergy> energy_;
  std::shared_ptr<numerics::EnergySum> sums_;
  std::unique_ptr<numerics::System<NetworkState>> system_;
  numerics::ShiftedCholesky cholesky_;
  State start_;               ///< start of the load increment
  Eigen::VectorXd tangent_;   ///< change of the points' coordinates from there to the target, to first order
  bool has_factors_ = false;  ///< whether `cholesky_` has the factors of the Hessian at the start
  double start_energy_ = 0;
  double carried_energy_ = 0;      ///< at the end of the increment, with points that keep their barycentric coordinates
  double predicted_decrease_ = 0;  ///< decrease of the energy from there by a Newton step
};

}  // namespace supple::embedded
