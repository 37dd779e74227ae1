// The description of where a relaxation ended.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "euclidean_springs.h"
#include "relaxation_phases.h"
#include "supple/base/parallel_tasks.h"

namespace supple::embedded {
namespace {

using Termination = numerics::MinimizerTermination;

/// Relative compression of a spring that is no more than rounding.
constexpr double compression_rounding = 1e-9;
/// Springs whose final paths one task describes.
constexpr std::size_t springs_of_a_task = 64;

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return count == 1 ? "One " + one : std::to_string(count) + " " + many;
}

/// The volume of a closed surface; 0 for others.
double enclosed_volume(const surface::TriangleMesh& mesh) {
  for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h)
    if (mesh.twin(h) < 0) return 0;
  const Eigen::Vector3d origin = mesh.positions()[mesh.faces().front()[0]];
  double volume = 0;
  for (const auto& [a, b, c] : mesh.faces())
    volume += (mesh.positions()[a] - origin).dot((mesh.positions()[b] - origin).cross(mesh.positions()[c] - origin));
  return volume / 6;
}

double energy_of(const numerics::Term<NetworkState>& term, const NetworkState& state) {
  numerics::EnergySum sum;
  term.add(state, 0, sum);
  return sum.value;
}

std::string why_mollified(const RelaxationContext& context, bool is_mollified) {
  if (context.options.mollifier == Switch::on) return "asked for";
  if (context.options.mollifier == Switch::off) return "asked not to";
  if (!context.is_rigid()) return "there is none on a host that does not keep its shape";
  return is_mollified ? "the search without it did not converge, and a path passes through a vertex"
                      : "the search without it did not call for it";
}

void add_effects(const RelaxationContext& context, bool is_mollified) {
  CostLedger* cost = context.execution.cost;
  if (!cost) return;
  if (context.follows_geodesics()) {
    const bool reuses_strips = context.reuses_strips();
    cost->add_effect("mollifier", is_mollified, why_mollified(context, is_mollified), is_mollified ? 1 : 0);
    cost->add_effect(
        "kept_strips", reuses_strips,
        reuses_strips ? "a strip is unfolded again wherever no other path can be as short" : "asked not to",
        reuses_strips ? 1 : 0);
  }
  if (!context.is_rigid()) cost->add_effect("self_contact", false, "a host does not notice where it touches itself", 0);
}

SpringState describe_spring(const RelaxationContext& context, const Equilibrium& end, std::size_t i,
                            const Execution& execution) {
  const Spring& spring = context.network.springs[i];
  const NetworkState& state = end.state;
  SpringState result;
  const surface::SurfacePoint& from = state.points()[static_cast<std::size_t>(spring.from)];
  const surface::SurfacePoint& to = state.points()[static_cast<std::size_t>(spring.to)];
  if (context.follows_geodesics()) {
    surface::Geodesic path;
    const bool needs_search = context.options.paths || !state.found();
    if (needs_search) path = end.solver(context.solver).geodesic(from, to, {.path = context.options.paths}, execution);
    result.length = needs_search ? path.distance : state.found()->geodesics[i].distance;
    result.at_cut_locus = !((!needs_search || path.unique) && (!state.found() || state.found()->is_unique(i)));
    result.path = std::move(path.path);
  } else {
    const Eigen::Vector3d start = surface::position(state.mesh(), from);
    const Eigen::Vector3d target = surface::position(state.mesh(), to);
    result.length = (target - start).norm();
    if (context.options.paths) result.path = {{from, start}, {to, target}};
  }
  const double excess = result.length - spring.rest_length;
  result.energy = spring.weight * excess * excess;
  result.compressed = spring.weight > 0 && excess < -compression_rounding * spring.rest_length;
  return result;
}

std::vector<SpringState> describe_springs(const RelaxationContext& context, const Equilibrium& end) {
  const std::size_t count = context.network.springs.size();
  std::vector<SpringState> springs(count);
  const StageTimer timer(context.execution.cost, "paths");
  const std::size_t tasks = (count + springs_of_a_task - 1) / springs_of_a_task;
  const Execution quiet{context.execution.cancellation, nullptr, nullptr};
  parallel_tasks(static_cast<int>(tasks), quiet, "paths", [&](int task, const Execution& own) {
    const std::size_t begin = static_cast<std::size_t>(task) * springs_of_a_task;
    for (std::size_t i = begin; i < std::min(count, begin + springs_of_a_task); ++i)
      springs[i] = describe_spring(context, end, i, own);
  });
  return springs;
}

std::vector<TriangleState> describe_triangles(const ElasticNetwork& network, const NetworkState& state) {
  std::vector<TriangleState> triangles;
  for (std::size_t t = 0; t < network.triangles().size(); ++t) {
    const ElasticNetwork::Triangle& triangle = network.triangles()[t];
    TriangleState& result = triangles.emplace_back();
    const Eigen::Vector3d lengths = network.side_lengths(*state.found(), t);
    const TriangleEnergy::Value energy = triangle.energy.at(lengths);
    result.energy = energy.energy;
    const Eigen::Vector2d stretches = triangle.energy.stretches(lengths);
    result.stretches = {stretches[0], stretches[1]};
    for (std::size_t side = 0; side < 3; ++side)
      result.at_cut_locus = result.at_cut_locus || (energy.first[static_cast<Eigen::Index>(side)] < 0 &&
                                                    !state.found()->is_unique(triangle.sides[side].path));
  }
  return triangles;
}

HostState describe_host(const RelaxationContext& context, const Equilibrium& end) {
  HostState host;
  const NetworkState& state = end.state;
  for (const auto& term : context.host.terms())
    host.terms.push_back({std::string(term->name()), energy_of(*term, state)});
  const surface::TriangleMesh& rest = context.solver.mesh();
  const double rest_volume = enclosed_volume(rest);
  if (rest_volume != 0) host.volume_ratio = enclosed_volume(state.mesh()) / rest_volume;
  if (!context.host.is_deformable()) {
    host.vertices = state.mesh().positions();
    for (std::size_t i = 0; i < host.vertices.size(); ++i)
      host.largest_displacement = std::max(host.largest_displacement, (host.vertices[i] - rest.positions()[i]).norm());
    return host;
  }
  const Eigen::VectorXd& rest_nodes = context.host.nodes();
  const Eigen::Index nodes = state.nodes().size() / 3;
  for (Eigen::Index i = 0; i < nodes; ++i) {
    const Eigen::Vector3d at = state.nodes().segment<3>(3 * i);
    (i < rest.vertex_count() ? host.vertices : host.inside).push_back(at);
    host.largest_displacement = std::max(host.largest_displacement, (at - rest_nodes.segment<3>(3 * i)).norm());
  }
  host.tetrahedra = context.host.tetrahedra().tetrahedra;
  return host;
}

void warn_of_host(const RelaxationContext& context, Relaxation& result) {
  if (const int parts = context.host.rigid_body_constraints(); parts > 0)
    result.warnings.push_back("No fixed vertices hold " + std::string(parts == 1 ? "the host" : "parts of the host") +
                              " as a whole: three of its vertices are held just enough that it cannot drift or turn, "
                              "which takes no force.");
  if (context.host.is_deformable() && !result.stops.empty() && result.stops.back().reached < 1)
    result.warnings.push_back("Moved vertices came " + std::to_string(std::lround(100 * result.stops.back().reached)) +
                              " percent of the way to their position " + std::to_string(result.stops.size() - 1) +
                              ": shortly after, elements of the host would be turned inside out, or no equilibrium "
                              "is found.");
}

void warn_of_jumps(Relaxation& result) {
  std::size_t jumps = 0;
  std::string positions;
  for (std::size_t k = 0; k < result.stops.size(); ++k) {
    if (result.stops[k].jumps == 0) continue;
    jumps += static_cast<std::size_t>(result.stops[k].jumps);
    positions += (positions.empty() ? "" : ", ") + std::to_string(k);
  }
  if (jumps > 0)
    result.warnings.push_back(counted(jumps, "time", "times") + " on the way (to position " + positions +
                              ") the equilibrium was lost and another one of less energy was found: on the way back "
                              "the points need not return to where they were.");
}

void warn_of_compression(Relaxation& result, std::size_t springs_at_cut_loci, std::size_t triangles_at_cut_loci) {
  const auto compressed = static_cast<std::size_t>(std::ranges::count_if(result.springs, &SpringState::compressed));
  if (compressed > 0)
    result.warnings.push_back(
        counted(compressed, "spring is", "springs are") +
        " shorter than at rest: compression pushes a shortest path towards places where another becomes as short, "
        "and the energy has a kink there.");
  if (springs_at_cut_loci > 0)
    result.warnings.push_back(counted(springs_at_cut_loci, "spring", "springs") +
                              " under compression reached such a place: two shortest paths are equally long, and no "
                              "small motion of the ends lowers the energy along both.");
  if (triangles_at_cut_loci > 0)
    result.warnings.push_back(counted(triangles_at_cut_loci, "triangle has", "triangles have") +
                              " a side that pushes and has another shortest path: no small motion of its ends lowers "
                              "the energy along both.");
}

}  // namespace

std::string_view to_string(RelaxationTermination termination) {
  switch (termination) {
    case RelaxationTermination::converged:
      return "converged";
    case RelaxationTermination::cut_locus:
      return "cut_locus";
    case RelaxationTermination::step_too_small:
      return "step_too_small";
    case RelaxationTermination::deadline:
      return "deadline";
    case RelaxationTermination::memory:
      return "memory";
    case RelaxationTermination::iteration_limit:
      break;
  }
  return "iteration_limit";
}

RelaxationTermination relaxation_termination(numerics::MinimizerTermination termination) {
  switch (termination) {
    case numerics::MinimizerTermination::converged:
      return RelaxationTermination::converged;
    case numerics::MinimizerTermination::iteration_limit:
      return RelaxationTermination::iteration_limit;
    default:
      return RelaxationTermination::step_too_small;
  }
}

Relaxation describe_relaxation(const RelaxationContext& context, const FollowedEquilibrium& found, bool is_mollified,
                               RelaxationHistory history) {
  add_effects(context, is_mollified);
  const Equilibrium& end = found.end;
  const NetworkState& state = end.state;
  Relaxation result;
  result.points = state.points();
  result.springs = describe_springs(context, end);
  result.triangles = describe_triangles(*context.elements, state);
  result.energy = end.energy;
  result.network_energy = context.follows_geodesics()
                              ? energy_of(NetworkEnergy(context.solver, context.elements, {}), state)
                              : energy_of(EuclideanSprings(context.network), state);
  if (!context.is_rigid()) result.host = describe_host(context, end);
  result.stops = found.stops;
  result.gradient_norm = end.gradient_norm;
  result.gradient_tolerance = context.minimizer_options().gradient_tolerance;
  result.iterations = end.iterations;
  result.history = history.take();
  result.mollified = is_mollified;
  for (std::size_t i = 0; i < context.network.points.size(); ++i)
    if (!context.points.fixed[i] && state.on_tip(i)) result.at_vertices.push_back(static_cast<std::int32_t>(i));
  result.loose_points = context.points.loose;

  const auto springs_at_cut_loci = static_cast<std::size_t>(
      std::ranges::count_if(result.springs, [](const SpringState& s) { return s.compressed && s.at_cut_locus; }));
  const auto triangles_at_cut_loci =
      static_cast<std::size_t>(std::ranges::count_if(result.triangles, &TriangleState::at_cut_locus));
  const bool is_at_cut_locus = springs_at_cut_loci + triangles_at_cut_loci > 0;
  result.stopped = end.termination == Termination::step_too_small && is_at_cut_locus
                       ? RelaxationTermination::cut_locus
                       : relaxation_termination(end.termination);
  warn_of_host(context, result);
  warn_of_jumps(result);
  warn_of_compression(result, springs_at_cut_loci, triangles_at_cut_loci);
  if (!context.points.loose.empty())
    result.warnings.push_back(counted(context.points.loose.size(), "point is", "points are") +
                              " held by no spring of positive weight and no triangle, and stayed in place.");
  return result;
}

}  // namespace supple::embedded
