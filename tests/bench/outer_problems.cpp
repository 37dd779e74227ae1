#include "outer_problems.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "measurement.h"
#include "report.h"

namespace supple::bench {
namespace {

constexpr double equilibrium_tolerance = 1e-10;
/// A parameter this close to 0 or 1 in the unit box is at its bound.
constexpr double bound_margin = 1e-6;
/// A solver ended at a minimum of its own if no residual gradient of a parameter that can move has a larger cosine with
/// the residuals (MINPACK's test).
constexpr double stationary_cosine = 1e-3;

/// Waves on a target, about a seventh of its size, that no design follows.
void perturb(design::Target& target, RandomStream& random) {
  auto& points = target.control_points;
  double squares = 0;
  for (const auto& point : points) squares += point[1] * point[1];
  const auto n = static_cast<double>(points.size());
  const double size = std::sqrt(squares / n);
  for (int wave = 1; wave <= 4; ++wave) {
    const double height = 0.1 * size * random.normal();
    const double phase = random.uniform(0, 2 * std::numbers::pi);
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i][1] += height * std::cos(2 * std::numbers::pi * wave * static_cast<double>(i) / n + phase);
  }
}

/// Largest cosine between the residuals and the gradient of the residuals by a parameter, of those that a bound does
/// not hold.
double free_cosine(const Eigen::VectorXd& u, const Eigen::VectorXd& r, const Eigen::MatrixXd& jacobian) {
  double largest = 0;
  for (Eigen::Index k = 0; k < u.size(); ++k) {
    const double slope = jacobian.col(k).dot(r);
    const bool held = (u[k] <= 0 && slope > 0) || (u[k] >= 1 && slope < 0);
    const double sizes = jacobian.col(k).norm() * r.norm();
    if (!held && sizes > 0) largest = std::max(largest, std::abs(slope) / sizes);
  }
  return largest;
}

}  // namespace

design::TargetResiduals OuterProblem::residuals(const LoadedSpace& space) const {
  const auto& lower = space.model.network.lower;
  Eigen::VectorXd held(lower.size() + 1);
  held << lower, 0;  // the orientation
  std::vector<Eigen::Index> free(static_cast<std::size_t>(lower.size()));
  std::iota(free.begin(), free.end(), 0);
  return {space.evaluator, targets, {1.0}, held, free, equilibrium_tolerance};
}

OuterProblem draw_problem(const LoadedSpace& space, design::Task task, bool perturbed, RandomStream& random) {
  const auto& network = space.model.network;
  while (true) {
    const auto parameters = random_parameters(space.model, random);
    const double direction = random.uniform(0, std::numbers::pi);
    auto target = target_of(space, parameters, task, direction, random.uniform(0.01, 0.1));
    if (!target) continue;
    if (perturbed) perturb(*target, random);
    OuterProblem problem{{design::sample_target(*target)},
                         Eigen::VectorXd::NullaryExpr(network.lower.size(), [&random] { return random.uniform(); })};
    auto residuals = problem.residuals(space);
    Eigen::VectorXd r;
    if (RecordedResiduals(residuals, network.lower, network.upper).residuals(problem.start, r)) return problem;
  }
}

std::string OuterRun::ms_to(double limit) const {
  if (norm > limit) return "none";
  const auto at =
      std::find_if(improvements.begin(), improvements.end(), [limit](const auto& i) { return i.norm <= limit; });
  return number(1e3 * (at == improvements.end() ? seconds : at->seconds));
}

bool OuterRun::on_one_branch() const { return std::abs(norm - improvements.back().norm) <= reached_margin; }

OuterRun solve(const LoadedSpace& space, const OuterProblem& problem, const OuterSolver& solver) {
  const auto& network = space.model.network;
  auto residuals = problem.residuals(space);
  RecordedResiduals recorded(residuals, network.lower, network.upper);
  OuterRun run;
  run.seconds = cpu_time([&] { run.ending = solver.run(recorded, problem.start); });
  run.evaluations = recorded.evaluations();
  run.jacobians = recorded.jacobians();
  run.improvements = recorded.improvements();
  run.best = recorded.best();

  auto from_rest = problem.residuals(space);
  RecordedResiduals judged(from_rest, network.lower, network.upper);
  Eigen::VectorXd r;
  if (judged.residuals(run.best, r)) {
    Eigen::MatrixXd jacobian;
    judged.jacobian(jacobian);
    run.norm = r.norm();
    run.cosine = free_cosine(run.best, r, jacobian);
  }
  return run;
}

std::string outcome_of(const OuterRun& run, double limit) {
  if (run.norm <= limit) return "reached";
  if (!run.on_one_branch()) return "other_branch";
  if (run.ending == Ending::limit) return "limit";
  if (run.ending == Ending::gave_up) return "gave_up";
  return run.cosine <= stationary_cosine ? "other_minimum" : "stalled";
}

std::string to_string(Place place) {
  return place == Place::inside ? "inside" : place == Place::at_bound ? "at_bound" : "branches";
}

Place place_of(const std::vector<OuterRun>& runs, const OuterRun& best) {
  if (!std::all_of(runs.begin(), runs.end(), [](const OuterRun& run) { return run.on_one_branch(); }))
    return Place::branches;
  const bool at_bound = best.best.minCoeff() <= bound_margin || best.best.maxCoeff() >= 1 - bound_margin;
  return at_bound ? Place::at_bound : Place::inside;
}

}  // namespace supple::bench
