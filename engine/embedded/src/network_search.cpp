#include "network_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "cone_vertices.h"
#include "constrained_points.h"
#include "cut_locus_crossings.h"
#include "length_elements.h"
#include "supple/numerics/minimizer.h"
#include "supple/numerics/system.h"

namespace supple::embedded {
namespace {

/// A vertex is a candidate for a point if its distance is at most this many times the length of the point's trial step.
constexpr double max_vertex_distance = 2;
/// Points nearer to a vertex than this, in mean edges, are at it but for rounding.
constexpr double point_rounding = 1e-13;
/// Points nearer to a vertex than this, in mean edges, are put there: rounding of the vertex's direction decides on
/// which side a step passes it.
constexpr double max_distance_put_at_vertex = 1e-9;
/// Points are minimized separately if the excess of their elements over the quadratic model is at least this fraction
/// of the worst point's, and only so many.
constexpr double min_excess_fraction = 0.02;
constexpr std::size_t max_exceeding_points = 64;
/// After this many trial steps no points are minimized separately: a few points no longer keep the energy up.
constexpr std::size_t max_trials = 8;
/// Effort for a single point. Its exact minimum is not needed, because the others move on.
constexpr int max_point_iterations = 12;
constexpr double point_tolerance = 1e-8;

/// Energy of an element after a step, minus the quadratic model of its energy before the step.
template <class Element>
double excess_over_model(const Element& before, double after, const Eigen::VectorXd& all_steps) {
  auto step = before.gradient;
  for (Eigen::Index k = 0; k < step.size(); ++k) step[k] = all_steps[before.rows[static_cast<std::size_t>(k)]];
  return after - (before.value + before.gradient.dot(step) + 0.5 * step.dot(before.hessian * step));
}

/// For each point the summed excess of its elements.
template <class Elements>
std::vector<double> excess_at_points(const ElasticNetwork& network, const Elements& elements,
                                     const NetworkState& current, const NetworkState& trial) {
  std::vector<double> excess(network.point_count(), 0);
  const Eigen::VectorXd& step = trial.last_step();
  for (std::size_t i = 0; i < network.springs().size(); ++i) {
    const Spring& spring = network.springs()[i];
    const surface::TangentGeodesic& geodesic = current.found()->geodesics[i];
    const double after = network.spring_energy(*trial.found(), i);
    const double own = geodesic.coincident()
                           ? excess_over_model(spring_element_at_zero(spring, geodesic.turn, i), after, step)
                           : excess_over_model(elements.spring(i, 2), after, step);
    for (const std::int32_t end : {spring.from, spring.to}) excess[static_cast<std::size_t>(end)] += own;
  }
  for (std::size_t t = 0; t < network.triangles().size(); ++t) {
    const ElasticNetwork::Triangle& triangle = network.triangles()[t];
    const double after = triangle.energy.at(network.side_lengths(*trial.found(), t)).energy;
    const double own = excess_over_model(elements.triangle(t, 2), after, step);
    for (const std::int32_t corner : triangle.given.corners) excess[static_cast<std::size_t>(corner)] += own;
  }
  return excess;
}

}  // namespace

NetworkSearch::NetworkSearch(const surface::GeodesicSolver& solver, std::shared_ptr<const ElasticNetwork> network,
                             Options options)
    : solver_(solver), network_(std::move(network)), options_(options) {}

std::vector<NetworkSearch::Candidate> NetworkSearch::candidates(const NetworkState& current,
                                                                const std::vector<NetworkState>& trials,
                                                                double /*reach*/) const {
  if (trials.empty()) return {};
  std::vector<Candidate> candidates;
  if (options_.keeps_cut_loci) candidates = cut_locus_candidates(*network_, current, trials);
  if (auto at_vertices = points_put_at_vertices(current)) candidates.push_back(std::move(*at_vertices));
  if (network_->free_points().size() == 1) {
    std::ranges::move(vertices_near(network_->free_points().front(), current, trials), std::back_inserter(candidates));
    return candidates;
  }
  if (trials.size() > max_trials) return candidates;
  const NetworkState& whole_step = trials.front();
  const NetworkState& last = trials.back();
  const std::vector<std::size_t> points = points_exceeding_quadratic_model(current, whole_step);
  if (points.empty()) return candidates;
  const auto count = static_cast<std::int64_t>(trials.size());
  candidates.push_back({whole_step, 2 * count, whole_step.last_step().norm(), false});
  minimize_points(candidates.back().state, points, last);
  // Where the whole step of the others does not suit these points yet, the last trial step with their minima is better
  // than this trial step alone.
  candidates.push_back({last, 2 * count + 1, last.last_step().norm(), false});
  minimize_points(candidates.back().state, points, last);
  return candidates;
}

std::vector<std::size_t> NetworkSearch::points_exceeding_quadratic_model(const NetworkState& current,
                                                                         const NetworkState& trial) const {
  if (!current.found() || !trial.found() || trial.last_step().size() == 0) return {};
  const bool is_deformable = current.host_lengths() && current.host_lengths()->order >= 2;
  const std::vector<double> excess =
      is_deformable ? excess_at_points(*network_, DeformableHostElements(*network_, current, false), current, trial)
                    : excess_at_points(*network_, RigidHostElements(*network_, *current.found()), current, trial);
  const double worst = *std::ranges::max_element(excess);
  std::vector<std::size_t> points;
  for (std::size_t i = 0; i < excess.size(); ++i)
    if (!network_->fixed()[i] && excess[i] > min_excess_fraction * worst) points.push_back(i);
  std::ranges::stable_sort(points, std::ranges::greater(), [&](std::size_t i) { return excess[i]; });
  if (points.size() > max_exceeding_points) points.resize(max_exceeding_points);
  return points;
}

void NetworkSearch::minimize_points(NetworkState& state, const std::vector<std::size_t>& points,
                                    const NetworkState& starts) const {
  for (const std::size_t i : points) {
    Network own = network_->elements_of(i, state.points());
    own.points.front() = starts.points()[i];
    std::vector<bool> fixed(own.points.size(), true);
    fixed.front() = false;
    Options options = options_;
    options.keeps_cut_loci = options_.keeps_cut_loci && !state.surface();
    const NetworkTerm term = network_term(solver_of(state), own, fixed, options);
    numerics::System<NetworkState> system(NetworkState(state.mesh(), own.points), {term.energy},
                                          numerics::Unknowns(fixed_coordinates(fixed)), {}, term.search);
    // With the others where they are, a triangle may have no area: then there is no energy to lower.
    if (!std::isfinite(system.evaluate(0).value)) continue;
    numerics::MinimizerOptions effort;
    effort.max_iterations = max_point_iterations;
    effort.gradient_tolerance = point_tolerance * network_->stiffness_at(i) * state.mesh().mean_edge_length();
    numerics::minimize(system, effort);
    state.place(i, system.state().points().front());
  }
}

std::vector<NetworkSearch::Candidate> NetworkSearch::vertices_near(std::size_t point, const NetworkState& current,
                                                                   const std::vector<NetworkState>& trials) const {
  if (current.on_tip(point)) return {};
  const surface::TriangleMesh& mesh = current.mesh();
  const Eigen::Vector3d here = surface::position(mesh, current.points()[point]);
  std::vector<Candidate> candidates;
  const auto add_corners = [&](FaceId face, double max_distance) {
    for (const std::int32_t vertex : mesh.faces()[index(face)]) {
      const double distance = (mesh.positions()[vertex] - here).norm();
      if (distance > max_distance) continue;
      if (std::ranges::find(candidates, vertex, &Candidate::id) != candidates.end()) continue;
      if (!surface::VertexCone(mesh, vertex).bends_paths()) continue;
      if (!rests_at_vertex(*network_, solver_of(current), current, point, vertex)) continue;
      candidates.push_back({current, vertex, distance, distance <= point_rounding * mesh.mean_edge_length()});
      candidates.back().state.place(point, surface::vertex_point(mesh, VertexId{vertex}));
    }
  };
  for (const NetworkState& trial : trials) {
    const double step = (surface::position(mesh, trial.points()[point]) - here).norm();
    if (!(step > 0)) continue;
    add_corners(trial.points()[point].face, max_vertex_distance * step);
    add_corners(current.points()[point].face, max_vertex_distance * step);
  }
  return candidates;
}

std::optional<NetworkSearch::Candidate> NetworkSearch::points_put_at_vertices(const NetworkState& current) const {
  const surface::TriangleMesh& mesh = current.mesh();
  std::optional<Candidate> candidate;
  for (const std::size_t i : network_->free_points()) {
    if (current.on_tip(i)) continue;
    const surface::SurfacePoint& point = current.points()[i];
    const Eigen::Vector3d here = surface::position(mesh, point);
    for (const std::int32_t vertex : mesh.faces()[index(point.face)]) {
      if ((mesh.positions()[vertex] - here).norm() > max_distance_put_at_vertex * mesh.mean_edge_length()) continue;
      if (!surface::VertexCone(mesh, vertex).bends_paths()) continue;
      if (!candidate) candidate = Candidate{current, -2 - static_cast<std::int64_t>(network_->paths().size()), 0, true};
      candidate->state.place(i, surface::vertex_point(mesh, VertexId{vertex}));
      break;
    }
  }
  return candidate;
}

NetworkTerm network_term(const surface::GeodesicSolver& solver, const std::shared_ptr<const ElasticNetwork>& network,
                         const NetworkSearch::Options& options) {
  return {std::make_shared<NetworkEnergy>(solver, network, options.paths),
          std::make_shared<NetworkSearch>(solver, network, options)};
}

NetworkTerm network_term(const surface::GeodesicSolver& solver, const Network& network, std::vector<bool> fixed,
                         const NetworkSearch::Options& options) {
  return network_term(solver, std::make_shared<const ElasticNetwork>(network, std::move(fixed)), options);
}

}  // namespace supple::embedded
