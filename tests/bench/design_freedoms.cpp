// What the freedoms besides a family's parameters cost and gain: Young's modulus, orientation, limits.
#include <cmath>
#include <functional>
#include <numbers>

#include "design_bench.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/error.h"
#include "supple/design/verified_designs.h"

namespace supple::bench {
namespace {

using std::numbers::pi;

/// A target, and what the design that it was made from has besides parameters.
struct Made {
  design::Target target;
  double modulus = 0;
  double orientation = 0;
  double density = 0;
};

/// The stiffness over 50 directions of a random design of a random modulus that lies in a random orientation.
std::optional<Made> made_target(const LoadedSpace& space, const design::DesignSpace& measured, RandomStream& random) {
  const auto parameters = random_parameters(space.model, random);
  Made made;
  const double model_modulus = space.model.provenance.youngs_modulus;
  made.modulus = model_modulus * std::exp(random.uniform(std::log(0.1), std::log(100)));
  made.orientation = random.uniform(0, pi);
  auto target = target_of(space, parameters, design::Task::stiffness, 0, 0.05);
  const Eigen::VectorXd all =
      Eigen::Map<const Eigen::VectorXd>(parameters.data(), static_cast<Eigen::Index>(parameters.size()));
  if (!target || !measured.buildable(all)) return std::nullopt;
  made.density = measured.measure(all).relative_density;
  design::ProfileSamples samples{design::Task::stiffness, 0, 0.05, design::StrainMeasure::green, {}, made.orientation};
  for (const auto& point : target->control_points) samples.x.push_back(point[0]);
  const auto y = evaluate_profile(space.model, space.evaluator, parameters, samples).y;
  for (Eigen::Index i = 0; i < y.size(); ++i)
    target->control_points[static_cast<std::size_t>(i)][1] = made.modulus / model_modulus * y[i];
  made.target = *std::move(target);
  return made;
}

/// What a search is told, and what it has to find.
struct Freedom {
  const char* name;
  std::function<void(design::DesignProblem&, const Made&)> set;
};

void tell_modulus(design::DesignProblem& problem, const Made& made) { problem.moduli = {{made.modulus, made.modulus}}; }
void tell_orientation(design::DesignProblem& problem, const Made& made) {
  problem.orientation = {made.orientation, made.orientation};
}
void open_modulus(design::DesignProblem& problem, const Made&) { problem.moduli = {{1, 1e4}}; }
void open_orientation(design::DesignProblem& problem, const Made&) { problem.orientation = {0, pi}; }

const std::vector<Freedom>& freedoms() {
  static const std::vector<Freedom> all{
      {"parameters alone",
       [](design::DesignProblem& problem, const Made& made) {
         tell_modulus(problem, made);
         tell_orientation(problem, made);
       }},
      {"modulus",
       [](design::DesignProblem& problem, const Made& made) {
         open_modulus(problem, made);
         tell_orientation(problem, made);
       }},
      {"orientation",
       [](design::DesignProblem& problem, const Made& made) {
         tell_modulus(problem, made);
         open_orientation(problem, made);
       }},
      {"both",
       [](design::DesignProblem& problem, const Made& made) {
         open_modulus(problem, made);
         open_orientation(problem, made);
       }},
      {"both, at most 0.9 of the density",
       [](design::DesignProblem& problem, const Made& made) {
         open_modulus(problem, made);
         open_orientation(problem, made);
         problem.limits.relative_density.most = 0.9 * made.density;
       }},
  };
  return all;
}

}  // namespace

void study_freedoms(const DesignSettings& settings) {
  const int designs = settings.designs > 0 ? settings.designs : settings.brief ? 1 : 20;
  Report report(settings.folder, "designs-freedoms", "Inverse design: modulus, orientation and limits");
  Table table("designs-freedoms", {{"family", "Family"},
                                   {"open", "Found besides the parameters"},
                                   {"targets", "Targets"},
                                   {"median_error", "Deviation, median"},
                                   {"worst_error", "Worst"},
                                   {"found", "Below 1 %"},
                                   {"within", "Within the limits"},
                                   {"median_ms", "Median ms"},
                                   {"p90_ms", "90th percentile ms"}});
  for (const auto& space : spaces_of(settings)) {
    const auto measured = design::design_space(space->model, space->evaluator, space->candidates);
    RandomStream random("freedoms " + space->model.family, 1);
    std::vector<Made> targets;
    while (static_cast<int>(targets.size()) < designs)
      if (auto made = made_target(*space, measured, random)) targets.push_back(*std::move(made));
    for (const Freedom& freedom : freedoms()) {
      std::vector<double> errors, seconds;
      int within = 0;
      for (const Made& made : targets) {
        design::DesignProblem problem{{made.target}, {}, {}};
        freedom.set(problem, made);
        seconds.push_back(cpu_time([&] {
          try {
            const auto found = design::find_design(measured, problem);
            errors.push_back(found.error.relative_rms);
            const double density = measured.measure(found.parameters).relative_density;
            if (density <= problem.limits.relative_density.most) ++within;
          } catch (const Error& failure) {
            std::printf("%s: %s\n", space->model.family.c_str(), failure.what());
          }
        }));
      }
      const auto below = std::count_if(errors.begin(), errors.end(), [](double error) { return error < 0.01; });
      table.row({space->model.family, freedom.name, count(static_cast<double>(targets.size())),
                 errors.empty() ? "" : number(median(errors)), errors.empty() ? "" : number(quantile(errors, 1)),
                 count(static_cast<double>(below)), count(within), number(1e3 * median(seconds)),
                 number(1e3 * quantile(seconds, 0.9))});
    }
  }
  report.table(table);
  report.write(design_introduction(
      settings, "freedoms",
      "Targets are the stiffness over 50 directions of random designs within the bounds, whose material has a Young's "
      "modulus from 2.6 to 2600 MPa and whose tiling lies in a random orientation. The first row of a family tells the "
      "search both; in the others it finds the modulus between 1 and 10,000 MPa, the orientation within half a turn, "
      "or both. The last row leaves out the densest tenth, in which the design lies that the target was made from, so "
      "that other designs have to come as close as they can; where a family has none that is so light, no design is "
      "found."));
}

}  // namespace supple::bench
