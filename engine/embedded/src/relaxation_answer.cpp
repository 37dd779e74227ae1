#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "geodesic_elements.h"
#include "relaxation_run.h"
#include "supple/base/parallel_tasks.h"

namespace supple::embedded {
namespace {

/// A spring at its rest length is compressed by rounding only.
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

}  // namespace

std::string RelaxationRun::why_mollified() const {
  if (options_.mollifier == Switch::on) return "asked for";
  if (options_.mollifier == Switch::off) return "asked not to";
  if (!keeps_shape()) return "there is none on a host that does not keep its shape";
  return result_.mollified ? "the search without it did not converge, and a path passes through a vertex"
                           : "the search without it did not call for it";
}

bool RelaxationRun::some_path_is_pinned() const {
  return state_.found() && std::ranges::any_of(state_.found()->geodesics, &surface::TangentGeodesic::pinned);
}

void RelaxationRun::add_effects() {
  if (!execution_.cost) return;
  if (is_geodesic()) {
    execution_.cost->add_effect("mollifier", result_.mollified, why_mollified(), result_.mollified ? 1 : 0);
    execution_.cost->add_effect(
        "kept_strips", keeps_strips(),
        keeps_strips() ? "a strip is unfolded again wherever no other path can be as short" : "asked not to",
        keeps_strips() ? 1 : 0);
  }
  if (!keeps_shape())
    execution_.cost->add_effect("self_contact", false, "a host does not notice where it touches itself", 0);
}

void RelaxationRun::describe(Stop stop) {
  result_.points = state_.points();
  result_.loose_points = points_.loose;
  for (std::size_t i = 0; i < network_.points.size(); ++i)
    if (!points_.held[i] && state_.on_tip(i)) result_.at_vertices.push_back(static_cast<std::int32_t>(i));
  describe_springs();
  describe_triangles();
  describe_host();
  add_warnings(stop);
}

void RelaxationRun::describe_springs() {
  result_.springs.resize(network_.springs.size());
  const StageTimer timer(execution_.cost, "paths");
  const std::size_t tasks = (network_.springs.size() + springs_of_a_task - 1) / springs_of_a_task;
  const Execution quiet{execution_.cancellation, nullptr, nullptr};
  parallel_tasks(static_cast<int>(tasks), quiet, "paths", [&](int t, const Execution& own) {
    const std::size_t begin = static_cast<std::size_t>(t) * springs_of_a_task;
    for (std::size_t i = begin; i < std::min(network_.springs.size(), begin + springs_of_a_task); ++i)
      describe_spring(i, own);
  });
}

void RelaxationRun::describe_spring(std::size_t i, const Execution& execution) {
  const Spring& spring = network_.springs[i];
  SpringState& told = result_.springs[i];
  const surface::SurfacePoint& from = state_.points()[static_cast<std::size_t>(spring.from)];
  const surface::SurfacePoint& to = state_.points()[static_cast<std::size_t>(spring.to)];
  if (is_geodesic()) {
    surface::Geodesic path;
    const bool ask = options_.paths || !state_.found();
    if (ask) path = solver().geodesic(from, to, {.path = options_.paths}, execution);
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
}

void RelaxationRun::describe_triangles() {
  if (network_.triangles.empty()) return;
  const GeodesicElements elements(solver(), network_, points_.held, {});
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

void RelaxationRun::describe_host() {
  if (keeps_shape()) return;
  HostState& host = result_.host;
  const surface::TriangleMesh& rest = solver_.mesh();
  const double before = enclosed_volume(rest);
  if (before != 0) host.volume_ratio = enclosed_volume(state_.mesh()) / before;
  if (moved_) {
    host.vertices = state_.mesh().positions();
    for (std::size_t i = 0; i < host.vertices.size(); ++i)
      host.largest_displacement = std::max(host.largest_displacement, (host.vertices[i] - rest.positions()[i]).norm());
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
    result_.warnings.push_back("No fixed vertices hold " +
                               std::string(host_.supports() == 1 ? "the host" : "parts of the host") +
                               " as a whole: three of its vertices are held just enough that it cannot drift or turn, "
                               "which takes no force.");
  if (!result_.stops.empty() && result_.stops.back().reached < 1)
    result_.warnings.push_back("Moved vertices came " +
                               std::to_string(std::lround(100 * result_.stops.back().reached)) +
                               " percent of the way to their position " + std::to_string(result_.stops.size() - 1) +
                               ": shortly after, elements of the host would be turned inside out, or no equilibrium "
                               "is found.");
}

void RelaxationRun::add_warnings(Stop stop) {
  warn_of_jumps();
  const auto compressed = static_cast<std::size_t>(std::ranges::count_if(result_.springs, &SpringState::compressed));
  const auto torn = static_cast<std::size_t>(
      std::ranges::count_if(result_.springs, [](const SpringState& s) { return s.compressed && s.at_cut_locus; }));
  const auto torn_triangles =
      static_cast<std::size_t>(std::ranges::count_if(result_.triangles, &TriangleState::at_cut_locus));
  result_.stopped = std::string(numerics::to_string(stop));
  if (stop == Stop::step_too_small && torn + torn_triangles > 0) result_.stopped = "cut_locus";
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
    result_.warnings.push_back(counted(torn_triangles, "triangle has", "triangles have") +
                               " a side that pushes and has another shortest path: no small motion of its ends lowers "
                               "the energy along both.");
  if (!points_.loose.empty())
    result_.warnings.push_back(counted(points_.loose.size(), "point is", "points are") +
                               " held by no spring of positive weight and no triangle, and stayed in place.");
}

void RelaxationRun::warn_of_jumps() {
  std::size_t jumps = 0;
  std::string positions;
  for (std::size_t k = 0; k < result_.stops.size(); ++k) {
    if (result_.stops[k].jumps == 0) continue;
    jumps += static_cast<std::size_t>(result_.stops[k].jumps);
    positions += (positions.empty() ? "" : ", ") + std::to_string(k);
  }
  if (jumps > 0)
    result_.warnings.push_back(counted(jumps, "time", "times") + " on the way (to position " + positions +
                               ") the equilibrium was lost and another one of less energy was found: on the way back "
                               "the points need not return to where they were.");
}

}  // namespace supple::embedded
