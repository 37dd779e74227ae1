#pragma once

#include <memory>
#include <string>
#include <vector>

#include "constrained_points.h"
#include "host_model.h"
#include "moved_supports.h"
#include "moving_network.h"
#include "network_state.h"
#include "supple/embedded/relaxation.h"
#include "supple/numerics/equilibrium_path.h"
#include "supple/numerics/minimizer.h"
#include "supple/numerics/system.h"

namespace supple::embedded {

/// One call of `relax`: the search for the first equilibrium (relaxation_search.cpp), what is tried where paths at cut
/// loci hold it up (relaxation_jams.cpp), the equilibria that follow a host (relaxation_following.cpp), and the
/// description of the end (relaxation_answer.cpp).
class RelaxationRun {
 public:
  /// The network is a checked one. All arguments outlive this.
  RelaxationRun(const surface::GeodesicSolver& solver, const Network& network, const RelaxationOptions& options,
                const Execution& execution);

  Relaxation run();

 private:
  using Stop = numerics::MinimizerStop;
  using Terms = numerics::System<NetworkState>::Terms;
  using SurfacePath = numerics::EquilibriumPath<MovingNetwork>;
  using SupportPath = numerics::EquilibriumPath<MovedSupports>;

  bool is_geodesic() const { return options_.spring_length == SpringLength::geodesic; }
  bool keeps_strips() const { return options_.kept_strips != Switch::off; }
  bool keeps_shape() const;
  /// The surface as it is now.
  const surface::GeodesicSolver& solver() const;

  // relaxation_search.cpp
  NetworkState first_state() const;
  /// For each degree of freedom whether it is held, with these points held.
  std::vector<bool> held(const std::vector<bool>& points) const;
  std::shared_ptr<numerics::Term<NetworkState>> make_term(bool mollified, std::vector<bool> held_points) const;
  numerics::MinimizerOptions minimizer_options() const;
  void tell(const numerics::MinimizerStep& step, const NetworkState& state);
  Stop minimize(bool mollified, const Execution& execution) { return minimize(mollified, execution, points_.held); }
  /// From where the last search ended, with these points held.
  Stop minimize(bool mollified, const Execution& execution, const std::vector<bool>& held_points);
  void describe_energies(const Terms& terms);
  /// Throws "network.collapsed" if triangles have no area; other energies that are not finite are the minimizer's to
  /// refuse.
  void refuse_collapsed(const NetworkState& state) const;

  // relaxation_jams.cpp
  /// Goes on where the search ended although a gradient is left, since paths that push are at their cut loci.
  Stop leave_jam(bool mollified, const Execution& execution);
  std::vector<bool> jammed_points() const;
  bool may_go_on() const { return result_.iterations < iteration_limit_; }
  /// Moves single jammed points, the ends of each jammed path and all of them to lower energies, found by exact
  /// distances in directions all around. Returns whether any moved.
  bool move_jammed(const std::vector<bool>& jammed);
  bool move_group(const std::vector<std::int32_t>& group, std::uint64_t seed);

  // relaxation_following.cpp
  struct FollowCounts {
    int load_steps = 0;
    int jumps = 0;
    Stop stop = Stop::converged;
  };
  /// From the equilibrium on the mesh to those on all positions of the surface.
  Stop follow(const MovingHost& host, const Execution& execution);
  /// `step` is the length of the next load step.
  FollowCounts follow_surface(SurfacePath& path, MovingNetwork& scene, double target, double& step);
  /// Options of a search whose progress nobody is told.
  numerics::MinimizerOptions quiet_options() const;
  /// Leaves a jam at the present position of the surface. Returns why the search stopped; `jumps` counts a loss of
  /// energy.
  Stop leave_jam_of(MovingNetwork& scene, int& jumps, const Execution& execution);
  /// The scene's surface and points become those of this run.
  void adopt(MovingNetwork& scene);
  /// From the equilibrium with all vertices where they are at first to those with the moved ones at their positions.
  Stop move_supports(Stop start, const Execution& execution);
  /// `start` is why the search for the present state stopped.
  FollowCounts follow_supports(SupportPath& path, MovedSupports& scene, double target, Stop start,
                               const Execution& execution);
  /// Whether the way back from the equilibrium at hand leads to another one than that at an earlier load, which has
  /// this energy.
  static bool comes_back_elsewhere(SupportPath& path, MovedSupports& scene, double load, double energy);
  /// Where no load step finds an equilibrium although no element is turned inside out, the best state after one of at
  /// most this length is taken. Returns false where there is none.
  bool go_on_without_equilibrium(SupportPath& path, MovedSupports& scene, double target, double longest);

  // relaxation_answer.cpp
  std::string why_mollified() const;
  bool some_path_is_pinned() const;
  void add_effects();
  void describe(Stop stop);
  void describe_springs();
  void describe_spring(std::size_t i, const Execution& execution);
  void describe_triangles();
  void describe_host();
  void add_warnings(Stop stop);
  void warn_of_jumps();

  const surface::GeodesicSolver& solver_;  ///< of the mesh
  const Network& network_;
  const RelaxationOptions& options_;
  const Execution& execution_;
  ConstrainedPoints points_;
  HostModel host_;
  NetworkState state_;
  std::shared_ptr<const surface::GeodesicSolver> moved_;  ///< of a moving surface, where it is
  int iteration_limit_;  ///< of all iterations so far and those of the present position
  Relaxation result_;
};

}  // namespace supple::embedded
