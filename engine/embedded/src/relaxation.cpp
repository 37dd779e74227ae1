#include "supple/embedded/relaxation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <utility>
#include <variant>

#include "euclidean_springs.h"
#include "geodesic_elements.h"
#include "host_model.h"
#include "moved_supports.h"
#include "moving_network.h"
#include "supple/base/error.h"
#include "supple/base/faults.h"
#include "supple/base/parallel_tasks.h"
#include "supple/base/part_of_execution.h"
#include "supple/numerics/minimizer.h"
#include "supple/numerics/system.h"

namespace supple::embedded {
namespace {

/// Steps shorter than this share of the mesh diagonal do not move a point in double precision.
constexpr double shortest_step = 1e-16;
constexpr int most_backtracks = 40;
/// Directions of negative curvature are left by steps that are doubled up to this often, in length.
constexpr double longest_expansion = 64;
/// Forces of a host are known to this share of its stiffness times the mesh diagonal: where the network is that much
/// weaker, the tolerance is this.
constexpr double host_rounding = 1e-14;
/// A way between two positions of a moving surface is not divided below this share of it.
constexpr double shortest_load_step = 1.0 / 64;
/// See numerics::MinimizerOptions: an equilibrium that is followed does not drift where nothing holds it.
constexpr double least_regularization_of_a_path = 1e-6;
/// That of vertices of a host that are moved. Shorter ones help where elements are about to be turned inside out, and
/// not where an equilibrium is lost.
constexpr double shortest_support_step = 1.0 / 8;
constexpr double shortest_valid_step = 1.0 / 1024;
/// From a tangent a load step takes few iterations. Where a thin shell buckles on it, it takes some dozens, and shorter
/// ones do not find the way sooner.
constexpr int iterations_of_support_step = 80;
/// How often ends of paths at cut loci are held and let go, and by which share that has to lower the energy.
constexpr int most_jams = 20;
constexpr double least_gain = 1e-9;
/// Of the computation, until network and host are at rest and vertices are moved.
constexpr double share_before_moving = 0.2;
/// Springs whose final paths one task describes.
constexpr std::size_t springs_of_a_task = 64;

void check_options(const RelaxationOptions& options) {
  const auto refuse = [](const std::string& field, const std::string& what) {
    throw Error("network.invalid_option", "An option of the relaxation is out of range.", {{field, what}});
  };
  if (!std::isfinite(options.tolerance) || options.tolerance < 0)
    refuse("accuracy/tolerance", "is " + std::to_string(options.tolerance) + ", but must be finite and not negative");
  if (options.max_iterations < 0)
    refuse("max_iterations", "is " + std::to_string(options.max_iterations) + ", but must not be negative");
  if (!(options.mollifier_length > 0 && options.mollifier_length <= 0.5))
    refuse("accuracy/mollifier_length",
           "is " + std::to_string(options.mollifier_length) + ", but must be above 0 and at most 0.5");
}

numerics::MinimizerMethod minimizer_method(RelaxationMethod method) {
  switch (method) {
    case RelaxationMethod::newton:
      return numerics::MinimizerMethod::newton;
    case RelaxationMethod::lbfgs:
      return numerics::MinimizerMethod::lbfgs;
    case RelaxationMethod::gradient_descent:
      break;
  }
  return numerics::MinimizerMethod::gradient_descent;
}

/// What the network's elements say about its points before anything moves.
struct Holds {
  std::vector<bool> held;  ///< fixed or loose
  std::vector<std::int32_t> loose;
  double largest_stiffness = 0;  ///< of one point: twice the sum of its elements' weights
};

Holds holds_of(const Network& network) {
  Holds holds;
  std::vector<double> stiffness(network.points.size(), 0);
  for (const Spring& spring : network.springs) {
    stiffness[static_cast<std::size_t>(spring.from)] += 2 * spring.weight;
    stiffness[static_cast<std::size_t>(spring.to)] += 2 * spring.weight;
  }
  holds.held.resize(network.points.size(), false);
  // By lengths, a triangle's energy bends about as much as springs of this weight.
  const double membrane = network.material.youngs_modulus * network.material.thickness;
  for (const MembraneTriangle& triangle : network.triangles) {
    for (const std::int32_t corner : triangle.corners) stiffness[static_cast<std::size_t>(corner)] += 2 * membrane;
  }
  for (const std::int32_t point : network.fixed_points) holds.held[static_cast<std::size_t>(point)] = true;
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    holds.largest_stiffness = std::max(holds.largest_stiffness, stiffness[i]);
    if (stiffness[i] > 0 || holds.held[i]) continue;
    holds.held[i] = true;
    holds.loose.push_back(static_cast<std::int32_t>(i));
  }
  return holds;
}

std::vector<bool> held_coordinates(const std::vector<bool>& held) {
  std::vector<bool> coordinates(2 * held.size());
  for (std::size_t i = 0; i < held.size(); ++i) coordinates[2 * i] = coordinates[2 * i + 1] = held[i];
  return coordinates;
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return count == 1 ? "One " + one : std::to_string(count) + " " + many;
}

/// Of a closed surface; 0 for others.
double enclosed_volume(const surface::TriangleMesh& mesh) {
  for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h)
    if (mesh.twin(h) < 0) return 0;
  const Eigen::Vector3d origin = mesh.positions()[mesh.faces().front()[0]];
  double volume = 0;
  for (const auto& [a, b, c] : mesh.faces())
    volume += (mesh.positions()[a] - origin).dot((mesh.positions()[b] - origin).cross(mesh.positions()[c] - origin));
  return volume / 6;
}

class RelaxationRun {
 public:
  RelaxationRun(const surface::GeodesicSolver& solver, const Network& network, const RelaxationOptions& options,
                const Execution& execution)
      : solver_(solver),
        network_(network),
        options_(options),
        execution_(execution),
        holds_(holds_of(network)),
        host_(solver.mesh(), options.host, execution),
        state_(first_state()) {}

  Relaxation run() {
    const bool geodesic = options_.spring_length == SpringLength::geodesic;
    const bool mollified = geodesic && options_.mollifier == Switch::on;
    const auto* moving = std::get_if<MovingHost>(&options_.host);
    numerics::MinimizerStop stop;
    {
      const PartOfExecution part(execution_, 0, moving || !host_.moved().empty() ? share_before_moving : 1);
      stop = minimize(mollified, part.execution());
      if (geodesic && stop == numerics::MinimizerStop::step_too_small) stop = leave_jam(mollified, part.execution());
    }
    if (moving) stop = follow(*moving);
    if (!host_.moved().empty()) stop = move_supports();
    if (geodesic && keeps_shape() && options_.mollifier == Switch::automatic &&
        stop != numerics::MinimizerStop::converged && result_.iterations < options_.max_iterations &&
        some_path_is_pinned()) {
      result_.mollified = true;
      stop = minimize(true, execution_);
    }
    result_.mollified = result_.mollified || mollified;
    if (execution_.cost && geodesic)
      execution_.cost->add_effect("mollifier", result_.mollified, why_mollified(), result_.mollified ? 1 : 0);
    if (execution_.cost && geodesic)
      execution_.cost->add_effect(
          "kept_strips", keeps_strips(),
          keeps_strips() ? "a strip is unfolded again wherever no other path can be as short" : "asked not to",
          keeps_strips() ? 1 : 0);
    if (execution_.cost && !keeps_shape())
      execution_.cost->add_effect("self_contact", false, "a host does not notice where it touches itself", 0);
    describe(stop);
    return std::move(result_);
  }

 private:
  bool keeps_strips() const { return options_.kept_strips != Switch::off; }

  std::string why_mollified() const {
    if (options_.mollifier == Switch::on) return "asked for";
    if (options_.mollifier == Switch::off) return "asked not to";
    if (!keeps_shape()) return "there is none on a host that does not keep its shape";
    return result_.mollified ? "the search without it did not converge, and a path passes through a vertex"
                             : "the search without it did not call for it";
  }

  bool some_path_is_pinned() const {
    return state_.found() && std::ranges::any_of(state_.found()->geodesics, &surface::TangentGeodesic::pinned);
  }

  std::shared_ptr<numerics::Term<NetworkState>> make_term(bool mollified, std::vector<bool> held) const {
    if (options_.spring_length == SpringLength::euclidean) return std::make_shared<EuclideanSprings>(network_);
    return std::make_shared<GeodesicElements>(
        solver_, network_, std::move(held),
        GeodesicElementsOptions{.kept_strips = keeps_strips(),
                                .mollifier_length = mollified ? options_.mollifier_length : 0});
  }

  bool keeps_shape() const { return std::holds_alternative<RigidHost>(options_.host); }

  NetworkState first_state() const {
    if (!host_.gives_way()) return {solver_.mesh(), network_.points};
    // The caller's, who keeps it.
    return {std::shared_ptr<const surface::GeodesicSolver>(std::shared_ptr<void>(), &solver_), network_.points,
            host_.nodes()};
  }

  /// Of the surface as it is now.
  const surface::GeodesicSolver& solver() const {
    if (moved_) return *moved_;
    return state_.surface() ? *state_.surface() : solver_;
  }

  std::vector<bool> held(const std::vector<bool>& points) const {
    std::vector<bool> coordinates = held_coordinates(points);
    coordinates.insert(coordinates.end(), host_.held().begin(), host_.held().end());
    return coordinates;
  }

  numerics::MinimizerOptions minimizer_options() const {
    const double diagonal = solver_.mesh().diagonal();
    numerics::MinimizerOptions options;
    options.method = minimizer_method(options_.method);
    options.gradient_tolerance =
        std::max(options_.tolerance * largest_weight(network_), host_rounding * host_.stiffness()) * diagonal;
    options.step_tolerance = shortest_step * diagonal;
    options.max_backtracks = most_backtracks;
    options.longest_expansion = longest_expansion;
    // The length of a first step without curvature: that of a point which all others leave alone.
    if (const double stiffness = std::max(holds_.largest_stiffness, host_.stiffness()); stiffness > 0)
      options.first_step = 1 / stiffness;
    return options;
  }

  void tell(const numerics::MinimizerStep& step, const NetworkState& state) {
    result_.history.push_back({step.value, step.gradient_norm, step.step_length, step.regularization});
    if (options_.observer) options_.observer(result_.history.back(), state.points(), state.mesh());
  }

  /// From the equilibrium on the mesh to those on all positions of the surface.
  numerics::MinimizerStop follow(const MovingHost& host) {
    MovingNetwork scene(solver_, network_, holds_.held, held_coordinates(holds_.held), {.kept_strips = keeps_strips()},
                        host, result_.gradient_tolerance, execution_);
    scene.place(0, state_.points(), state_.cut_loci());
    numerics::PathOptions options;
    options.minimizer = minimizer_options();
    options.minimizer.after_step = [&](const numerics::MinimizerStep& step) {
      if (step.step_length > 0) tell(step, scene.system().state());
    };
    options.max_iterations = options_.max_iterations;
    options.smallest_step = shortest_load_step;
    options.leave_unstable = false;
    options.minimizer.least_regularization = least_regularization_of_a_path;
    numerics::EquilibriumPath<MovingNetwork> path(scene, options, execution_);
    numerics::MinimizerStop stop = numerics::MinimizerStop::converged;
    for (std::size_t k = 1; k <= host.positions.size(); ++k) {
      execution_.checkpoint(static_cast<double>(k - 1) / static_cast<double>(host.positions.size()), "step");
      const auto target = static_cast<double>(k);
      scene.announce(target);
      int load_steps = 0;
      int jumps = 0;
      while (scene.load() < target) {
        using Path = numerics::EquilibriumPath<MovingNetwork>;
        const Path::Snapshot before = path.snapshot();
        const bool failed = path.step(target - scene.load()) == Path::Progress::failed;
        if (failed) {
          // The best there is a short way on.
          const double on = before.state.load + shortest_load_step;
          scene.place(on < target ? on : target, before.state.points, before.state.cut_loci);
          path.settle();
        }
        const double way = scene.load() - before.state.load;
        if (!failed && scene.has_jumped() && way > shortest_load_step) {
          path.restore(before);
          path.set_next_step(way / 2);
          continue;
        }
        ++load_steps;
        if (failed || scene.has_jumped()) ++jumps;
      }
      stop = path.result().stop;
      const auto counts = path.take_counts();
      result_.stops.push_back({.energy = path.result().value,
                               .gradient_norm = path.result().gradient_norm,
                               .iterations = counts.iterations,
                               .load_steps = load_steps,
                               .jumps = jumps,
                               .stopped = std::string(numerics::to_string(stop))});
      result_.iterations += counts.iterations;
    }
    result_.energy = result_.stops.back().energy;
    result_.gradient_norm = result_.stops.back().gradient_norm;
    scene.system().evaluate(0);
    moved_ =
        std::make_shared<surface::GeodesicSolver>(std::make_shared<const surface::TriangleMesh>(scene.solver().mesh()));
    state_ = NetworkState(moved_->mesh(), scene.network_state().points());
    state_.set_found(scene.network_state().shared_found());
    describe_energies({scene.elements()});
    return stop;
  }

  /// From the equilibrium with all vertices where they are at first to those with the moved ones at their positions.
  numerics::MinimizerStop move_supports() {
    numerics::System<NetworkState>::Terms terms = host_.terms();
    terms.push_back(make_term(false, holds_.held));
    numerics::System<NetworkState> system(state_, terms, numerics::Unknowns(held(holds_.held)),
                                          {.execution = execution_});
    MovedSupports scene(system, host_.moved(), result_.gradient_tolerance);
    numerics::PathOptions options;
    options.minimizer = minimizer_options();
    options.minimizer.after_step = [&](const numerics::MinimizerStep& step) {
      if (step.step_length > 0) tell(step, system.state());
    };
    options.max_iterations = std::min(options_.max_iterations, iterations_of_support_step);
    options.smallest_step = shortest_support_step;
    numerics::EquilibriumPath<MovedSupports> path(scene, options, execution_);
    numerics::MinimizerStop stop = numerics::MinimizerStop::converged;
    int all_steps = 0;
    for (std::size_t k = 1; k <= scene.stops() && (k == 1 || result_.stops.back().reached == 1); ++k) {
      const auto target = static_cast<double>(k);
      scene.announce(target);
      int load_steps = 0;
      int jumps = 0;
      while (scene.load() < target && follow_supports(path, scene, target, jumps)) ++load_steps;
      const auto counts = path.take_counts();
      stop = path.result().stop;
      if (scene.load() < target)
        stop = path.stopped() == numerics::PathStop::iteration_limit ? numerics::MinimizerStop::iteration_limit
                                                                     : numerics::MinimizerStop::step_too_small;
      result_.stops.push_back({.energy = system.evaluate(0).value,
                               .gradient_norm = path.result().gradient_norm,
                               .iterations = counts.iterations,
                               .load_steps = std::max(1, load_steps),
                               .jumps = jumps,
                               .stopped = std::string(numerics::to_string(stop)),
                               .reached = scene.load() - (target - 1)});
      result_.iterations += counts.iterations;
      all_steps += load_steps;
    }
    result_.energy = result_.stops.back().energy;
    result_.gradient_norm = result_.stops.back().gradient_norm;
    if (execution_.cost)
      execution_.cost->add_effect("moved_vertices", true, "the host has vertices that are moved", all_steps);
    state_ = system.state();
    describe_energies(terms);
    return stop;
  }

  /// A load step of moved vertices. Where even the shortest finds no equilibrium although no element is turned inside
  /// out, the best state there is taken. False where there is none.
  bool follow_supports(numerics::EquilibriumPath<MovedSupports>& path, MovedSupports& scene, double target,
                       int& jumps) {
    using Progress = numerics::EquilibriumPath<MovedSupports>::Progress;
    const auto stops = static_cast<double>(scene.stops());
    const PartOfExecution part(execution_, share_before_moving, 1 - share_before_moving);
    part.execution().checkpoint(scene.load() / stops, "step");
    if (path.step(target - scene.load()) != Progress::failed) return true;
    scene.begin_step();
    double way = shortest_support_step;
    while (way >= shortest_valid_step) {
      const bool valid = scene.predict(std::min(1.0, way / (target - scene.load())));
      way /= 2;
      if (!valid) continue;
      path.set_max_iterations(options_.max_iterations);
      path.settle();
      path.set_max_iterations(std::min(options_.max_iterations, iterations_of_support_step));
      ++jumps;
      return true;
    }
    scene.restart_step();
    return false;
  }

  /// The ends of paths that push and are at their cut loci can jam all others: a step that is good for these is none
  /// for them. So they are held while the others come to rest, then the others while they do, and then all are free
  /// again. Where this lowers the energy it is repeated.
  numerics::MinimizerStop leave_jam(bool mollified, const Execution& execution) {
    auto stop = numerics::MinimizerStop::step_too_small;
    for (int round = 0; round < most_jams && stop == numerics::MinimizerStop::step_too_small; ++round) {
      const std::vector<bool> jammed = jammed_points();
      if (std::ranges::none_of(jammed, std::identity())) break;
      const double before = result_.energy;
      std::vector<bool> first = holds_.held;
      std::vector<bool> second = holds_.held;
      for (std::size_t i = 0; i < jammed.size(); ++i) (jammed[i] ? first : second)[i] = true;
      minimize(mollified, execution, first);
      minimize(mollified, execution, second);
      stop = minimize(mollified, execution, holds_.held);
      if (!(result_.energy < before * (1 - least_gain))) break;
    }
    return stop;
  }

  std::vector<bool> jammed_points() const {
    const GeodesicElements elements(solver(), network_, holds_.held, {});
    return elements.ends_that_push_at_cut_loci(*state_.found());
  }

  numerics::MinimizerStop minimize(bool mollified, const Execution& execution) {
    return minimize(mollified, execution, holds_.held);
  }
  /// With some points held, from where the last search ended.
  numerics::MinimizerStop minimize(bool mollified, const Execution& execution, const std::vector<bool>& held_points) {
    const bool again = !result_.history.empty();
    NetworkState start = !host_.gives_way() ? NetworkState(solver_.mesh(), state_.points())
                         : again            ? state_
                                            : first_state();
    // The network last: where its paths lead over other faces, only its own places in the Hessian are new.
    numerics::System<NetworkState>::Terms terms = host_.terms();
    terms.push_back(make_term(mollified, held_points));
    numerics::System<NetworkState> system(std::move(start), terms, numerics::Unknowns(held(held_points)),
                                          {.execution = execution_});
    if (!network_.triangles.empty() && !std::isfinite(system.evaluate(0).value)) refuse_collapsed(system.state());
    numerics::MinimizerOptions options = minimizer_options();
    options.max_iterations = options_.max_iterations - result_.iterations;
    options.after_step = [&](const numerics::MinimizerStep& step) { tell(step, system.state()); };
    const numerics::MinimizerResult found = numerics::minimize(system, options, execution);
    result_.iterations += found.iterations + (again ? 1 : 0);
    result_.energy = found.value;
    result_.gradient_norm = found.gradient_norm;
    result_.gradient_tolerance = options.gradient_tolerance;
    system.evaluate(0);
    state_ = system.state();
    describe_energies(terms);
    return found.stop;
  }

  void describe_energies(const numerics::System<NetworkState>::Terms& terms) {
    result_.host.terms.clear();
    for (const auto& term : terms) {
      numerics::EnergySum own;
      term->add(state_, 0, own);
      if (term == terms.back()) {
        result_.network_energy = own.value;
      } else {
        result_.host.terms.push_back({std::string(term->name()), own.value});
      }
    }
  }

  void describe_host() {
    if (keeps_shape()) return;
    HostState& host = result_.host;
    const surface::TriangleMesh& rest = solver_.mesh();
    const double before = enclosed_volume(rest);
    if (before != 0) host.volume_ratio = enclosed_volume(state_.mesh()) / before;
    if (moved_) {
      host.vertices = state_.mesh().positions();
      for (std::size_t i = 0; i < host.vertices.size(); ++i)
        host.largest_displacement =
            std::max(host.largest_displacement, (host.vertices[i] - rest.positions()[i]).norm());
      return;
    }
    const Eigen::Index nodes = state_.nodes().size() / 3;
    for (Eigen::Index i = 0; i < nodes; ++i) {
      const Eigen::Vector3d at = state_.nodes().segment<3>(3 * i);
      (i < rest.vertex_count() ? host.vertices : host.inside).push_back(at);
      host.largest_displacement = std::max(host.largest_displacement, (at - host_.nodes().segment<3>(3 * i)).norm());
    }
    host.tetrahedra = host_.tetrahedra().tetrahedra;
    if (host_.supports() > 0)
      result_.warnings.push_back(
          "No fixed vertices hold " + std::string(host_.supports() == 1 ? "the host" : "parts of the host") +
          " as a whole: three of its vertices are held just enough that it cannot drift or turn, "
          "which takes no force.");
    if (!result_.stops.empty() && result_.stops.back().reached < 1)
      result_.warnings.push_back("Moved vertices came " +
                                 std::to_string(std::lround(100 * result_.stops.back().reached)) +
                                 " percent of the way to their position " + std::to_string(result_.stops.size() - 1) +
                                 ": shortly after, elements of the host would be turned inside out, or no equilibrium "
                                 "is found.");
  }

  /// Other energies that are not finite are the minimizer's to refuse.
  void refuse_collapsed(const NetworkState& state) const {
    const GeodesicElements elements(solver_, network_, holds_.held, {});
    Faults faults;
    for (std::size_t t = 0; t < network_.triangles.size(); ++t)
      if (!std::isfinite(elements.energy_of(t).at(elements.lengths_of(*state.found(), t)).energy))
        faults.add("triangles/" + std::to_string(t), "has no area where its corners are");
    faults.throw_if_any("network.collapsed");
  }

  void describe(numerics::MinimizerStop stop) {
    result_.points = state_.points();
    result_.loose_points = holds_.loose;
    for (std::size_t i = 0; i < network_.points.size(); ++i)
      if (!holds_.held[i] && state_.on_tip(i)) result_.at_vertices.push_back(static_cast<std::int32_t>(i));
    describe_springs();
    describe_triangles();
    describe_host();
    const auto lost = std::accumulate(
        result_.stops.begin(), result_.stops.end(), std::size_t{0},
        [](std::size_t sum, const FollowedStop& stop) { return sum + static_cast<std::size_t>(stop.jumps); });
    if (lost > 0)
      result_.warnings.push_back(
          counted(lost, "time", "times") +
          " on the way the equilibrium was lost, and the points went to another one of less energy: on the way "
          "back they need not return to where they were.");
    const auto compressed = static_cast<std::size_t>(std::ranges::count_if(result_.springs, &SpringState::compressed));
    const auto torn = static_cast<std::size_t>(
        std::ranges::count_if(result_.springs, [](const SpringState& s) { return s.compressed && s.at_cut_locus; }));
    const auto torn_triangles =
        static_cast<std::size_t>(std::ranges::count_if(result_.triangles, &TriangleState::at_cut_locus));
    result_.stopped = std::string(numerics::to_string(stop));
    if (stop == numerics::MinimizerStop::step_too_small && torn + torn_triangles > 0) result_.stopped = "cut_locus";
    if (compressed > 0)
      result_.warnings.push_back(
          counted(compressed, "spring is", "springs are") +
          " shorter than at rest: compression pushes a shortest path towards places where another becomes as short, "
          "and the energy has a kink there.");
    if (torn > 0)
      result_.warnings.push_back(counted(torn, "spring", "springs") +
                                 " under compression reached such a place: two shortest paths are equally long, and no "
                                 "small motion of the ends lowers the energy along both.");
    if (torn_triangles > 0)
      result_.warnings.push_back(
          counted(torn_triangles, "triangle has", "triangles have") +
          " a side that pushes and has another shortest path: no small motion of its ends lowers "
          "the energy along both.");
    if (!holds_.loose.empty())
      result_.warnings.push_back(counted(holds_.loose.size(), "point is", "points are") +
                                 " held by no spring of positive weight and no triangle, and stayed in place.");
  }

  void describe_springs() {
    result_.springs.resize(network_.springs.size());
    const bool geodesic = options_.spring_length == SpringLength::geodesic;
    const auto describe = [&](std::size_t i, const Execution& own) {
      const Spring& spring = network_.springs[i];
      SpringState& told = result_.springs[i];
      const surface::SurfacePoint& from = state_.points()[static_cast<std::size_t>(spring.from)];
      const surface::SurfacePoint& to = state_.points()[static_cast<std::size_t>(spring.to)];
      if (geodesic) {
        surface::Geodesic path;
        const bool ask = options_.paths || !state_.found();
        if (ask) path = solver().geodesic(from, to, {.path = options_.paths}, own);
        told.length = ask ? path.distance : state_.found()->geodesics[i].distance;
        told.at_cut_locus = !((!ask || path.unique) && (!state_.found() || state_.found()->is_unique(i)));
        told.path = std::move(path.path);
      } else {
        const Eigen::Vector3d start = surface::position(state_.mesh(), from);
        const Eigen::Vector3d end = surface::position(state_.mesh(), to);
        told.length = (end - start).norm();
        if (options_.paths) told.path = {{from, start}, {to, end}};
      }
      const double excess = told.length - spring.rest_length;
      told.energy = spring.weight * excess * excess;
      told.compressed = spring.weight > 0 && excess < -compression_rounding * spring.rest_length;
    };
    const StageTimer timer(execution_.cost, "paths");
    const std::size_t tasks = (network_.springs.size() + springs_of_a_task - 1) / springs_of_a_task;
    const Execution quiet{execution_.cancellation, nullptr, nullptr};
    parallel_tasks(static_cast<int>(tasks), quiet, "paths", [&](int t, const Execution& own) {
      const std::size_t begin = static_cast<std::size_t>(t) * springs_of_a_task;
      for (std::size_t i = begin; i < std::min(network_.springs.size(), begin + springs_of_a_task); ++i)
        describe(i, own);
    });
  }

  void describe_triangles() {
    if (network_.triangles.empty()) return;
    const GeodesicElements elements(solver(), network_, holds_.held, {});
    for (std::size_t t = 0; t < network_.triangles.size(); ++t) {
      TriangleState& told = result_.triangles.emplace_back();
      const Eigen::Vector3d lengths = elements.lengths_of(*state_.found(), t);
      const TriangleEnergy::Value energy = elements.energy_of(t).at(lengths);
      told.energy = energy.energy;
      const Eigen::Vector2d stretches = elements.energy_of(t).stretches(lengths);
      told.stretches = {stretches[0], stretches[1]};
      for (int side = 0; side < 3; ++side)
        told.at_cut_locus =
            told.at_cut_locus || (energy.first[side] < 0 && !elements.side_is_unique(*state_.found(), t, side));
    }
  }

  /// A spring at its rest length is compressed by rounding only.
  static constexpr double compression_rounding = 1e-9;

  const surface::GeodesicSolver& solver_;
  const Network& network_;
  const RelaxationOptions& options_;
  const Execution& execution_;
  Holds holds_;
  HostModel host_;
  NetworkState state_;
  std::shared_ptr<const surface::GeodesicSolver> moved_;  ///< of a moving surface, where it ends
  Relaxation result_;
};

}  // namespace

Relaxation relax(const surface::GeodesicSolver& solver, const Network& network, const RelaxationOptions& options,
                 const Execution& execution) {
  check_options(options);
  if (options.spring_length == SpringLength::euclidean && !network.triangles.empty())
    throw Error("network.invalid_option", "The sides of triangles are shortest paths: there are no straight ones.",
                {{"spring_length", "is \"euclidean\", which triangles do not have"}});
  if (!std::holds_alternative<RigidHost>(options.host)) {
    if (options.spring_length == SpringLength::euclidean)
      throw Error("network.invalid_option", "On a host that does not keep its shape springs follow shortest paths.",
                  {{"spring_length", "is \"euclidean\", which only a rigid host has"}});
    if (options.mollifier == Switch::on)
      throw Error("network.invalid_option", "On a host that does not keep its shape paths are not mollified.",
                  {{"effects/mollifier", "is \"on\", which only a rigid host has"}});
  }
  const Network own = checked_network(solver.mesh(), network);
  execution.checkpoint(0, "search");
  Relaxation result = RelaxationRun(solver, own, options, execution).run();
  execution.checkpoint(1, "step");
  return result;
}

}  // namespace supple::embedded
