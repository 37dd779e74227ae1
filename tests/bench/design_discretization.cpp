// What the mesh of a simulation that verifies a design costs and errs by, and whether its estimate of that holds.
#include <cmath>
#include <map>
#include <numbers>

#include "design_bench.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/error.h"
#include "supple/design/verification.h"
#include "supple/microscale/accurate_simulation.h"
#include "supple/tiling/structure.h"

namespace supple::bench {
namespace {

/// Sizes of meshes over that of the verification's: others for comparison, and the reference.
constexpr double factors[] = {2, 1.4, 1, 0.7};
constexpr double reference_factor = 0.4;

/// Away from rest, and few: the mesh errs much alike along a path.
design::ProfileSamples samples_along(design::Task task, double direction) {
  if (task == design::Task::stress_strain)
    return {task, direction, 0, design::StrainMeasure::green, {-0.05, 0.05, 0.1}};
  return {task, 0, 0.05, design::StrainMeasure::green, {direction, direction + std::numbers::pi / 3}};
}

struct DiscretizationOutcome {
  std::vector<double> errors, estimates, seconds;
};

Eigen::VectorXd simulated(const std::string& family, const std::vector<double>& parameters,
                          const design::ProfileSamples& samples, double factor, bool extrapolated = true) {
  auto options = design::verification_options();
  options.mesh.mesh_size *= factor;
  if (!extrapolated) options.refinement = microscale::Refinement::off;
  return design::simulate_profile(tiling::make_structure(tiling::family(family), parameters), samples, options);
}

/// Of each factor. Designs that one mesh does not get through are left out.
std::map<double, DiscretizationOutcome> compare(const LoadedSpace& space, design::Task task, int designs) {
  const std::string& family = space.model.family;
  std::map<double, DiscretizationOutcome> outcomes;
  RandomStream random("discretization " + family, static_cast<std::uint64_t>(task) + 1);
  int done = 0;
  for (int i = 0; done < designs && i < most_draws_per_design * designs; ++i) {
    const auto parameters = random_parameters(space.model, random);
    const auto samples = samples_along(task, random.uniform(0, std::numbers::pi));
    try {
      const Eigen::VectorXd reference = simulated(family, parameters, samples, reference_factor);
      std::map<double, Eigen::VectorXd> answers;
      std::map<double, double> seconds;
      bool complete = reference.allFinite();
      for (const double factor : factors) {
        const double start = cpu_seconds();
        answers[factor] = simulated(family, parameters, samples, factor);
        seconds[factor] = cpu_seconds() - start;
        complete = complete && answers[factor].allFinite();
      }
      if (!complete) continue;
      for (const double factor : factors) {
        DiscretizationOutcome& outcome = outcomes[factor];
        outcome.errors.push_back(design::relative_difference(reference, answers[factor]).value_or(0));
        outcome.seconds.push_back(seconds[factor]);
        if (factor == 1)
          outcome.estimates.push_back(
              microscale::extrapolation_error_share() *
              design::relative_difference(answers[1], simulated(family, parameters, samples, 1, false)).value_or(0));
      }
      ++done;
    } catch (const Error& failure) {
      std::printf("%s: %s\n", family.c_str(), failure.what());
    }
  }
  return outcomes;
}

std::string percent(double share) { return number(100 * share); }

}  // namespace

void study_discretization(const DesignSettings& settings) {
  const int designs = settings.designs > 0 ? settings.designs : settings.brief ? 1 : 6;
  Report report(settings.folder, "designs-discretization", "Inverse design: what the mesh of a verification costs");
  Table table("designs-discretization", {{"family", "Family"},
                                         {"task", "Task"},
                                         {"mesh_size", "Mesh, beam widths"},
                                         {"corner_size", "Corners, mesh sizes"},
                                         {"designs", "Designs"},
                                         {"error_median", "Error, median, %"},
                                         {"error_worst", "Worst, %"},
                                         {"seconds", "CPU s, median"},
                                         {"estimate_median", "`discretization_error`, median, %"},
                                         {"held", "Designs that err by less than it"}});
  for (const auto& space : spaces_of(settings)) {
    const auto mesh = design::verification_options().mesh;
    for (const auto task : all_tasks) {
      if (settings.brief && task != design::Task::stress_strain) continue;
      for (const auto& [factor, outcome] : compare(*space, task, designs)) {
        const auto& errors = outcome.errors;
        const bool used = factor == 1;
        int held = 0;
        for (std::size_t i = 0; i < outcome.estimates.size(); ++i) held += errors[i] < outcome.estimates[i] ? 1 : 0;
        table.row({space->model.family, std::string(to_string(task)), number(mesh.mesh_size * factor),
                   number(mesh.corner_size), count(static_cast<double>(errors.size())), percent(median(errors)),
                   percent(quantile(errors, 1)), number(median(outcome.seconds)),
                   used ? percent(median(outcome.estimates)) : "", used ? count(held) : ""});
      }
    }
  }
  report.table(table);
  report.write(design_introduction(
      settings, "discretization",
      "Random designs within the bounds: stress at strains of -0.05, 0.05 and 0.1 along a random direction; stiffness "
      "and "
      "Poisson's ratio at a strain of 0.05 in two directions. Errors are relative root mean squares against a mesh of "
      "0.4 times the verification's, extrapolated like all of them. The verification's rows have an estimate: "
      "`discretization_error`, a share of the change by extrapolation. Where a structure buckles within the strains, "
      "one "
      "mesh may do so before the other, "
      "and "
      "a value changes by more than meshes err elsewhere."));
}

}  // namespace supple::bench
