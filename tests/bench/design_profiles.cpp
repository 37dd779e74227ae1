// What accuracy costs for the profile of a known design: the tolerance of its equilibria, and the number of samples.
#include <cmath>
#include <functional>
#include <vector>

#include "design_bench.h"
#include "measurement.h"
#include "report.h"
#include "supple/numerics/interpolant.h"

namespace supple::bench {
namespace {

using design::ProfileSamples;
using design::Task;

ProfileSamples samples_of(Task task, int n) {
  ProfileSamples samples;
  samples.task = task;
  samples.direction = 0.3;
  for (int i = 0; i < n; ++i)
    samples.x.push_back(task == Task::stress_strain ? -0.1 + 0.3 * i / (n - 1) : std::acos(-1.0) * i / n);
  return samples;
}

struct Run {
  Eigen::VectorXd y;
  double seconds = 0;
};

Run run_profile(const LoadedSpace& space, const std::vector<double>& parameters, const ProfileSamples& samples,
                double tolerance) {
  Run run;
  run.seconds = cpu_time(
      [&] { run.y = design::evaluate_profile(space.model, space.evaluator, parameters, samples, tolerance).y; });
  return run;
}

/// The root of the mean square of the differences over that of the reference.
double relative_difference(const Eigen::VectorXd& y, const Eigen::VectorXd& reference) {
  return (y - reference).norm() / reference.norm();
}

/// Values between samples by the spline that targets use.
Eigen::VectorXd interpolated(const ProfileSamples& coarse, const Eigen::VectorXd& y, const ProfileSamples& fine) {
  const std::vector<double> values(y.begin(), y.end());
  const double period = coarse.task == Task::stress_strain ? 0 : std::acos(-1.0);
  const numerics::Interpolant curve(coarse.x, values, numerics::Interpolation::cubic, period);
  Eigen::VectorXd at_all(static_cast<Eigen::Index>(fine.x.size()));
  for (std::size_t i = 0; i < fine.x.size(); ++i) at_all[static_cast<Eigen::Index>(i)] = curve(fine.x[i]);
  return at_all;
}

struct Errors {
  std::vector<double> errors, seconds;
};

void add_row(Table& table, const LoadedSpace& space, Task task, const std::string& value, const Errors& found) {
  table.row({space.model.family, std::string(to_string(task)), value, number(1e3 * median(found.seconds)),
             number(100 * median(found.errors), 2), number(100 * quantile(found.errors, 1), 2)});
}

}  // namespace

void study_profiles(const DesignSettings& settings) {
  const int designs = settings.designs > 0 ? settings.designs : settings.brief ? 1 : 10;
  constexpr double tightest = 1e-13;
  const std::vector<double> tolerances =
      settings.brief ? std::vector<double>{1e-4, 1e-10} : std::vector<double>{1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12};
  const std::vector<int> counts = settings.brief ? std::vector<int>{10} : std::vector<int>{6, 10, 25, 50, 100};
  const int finest = settings.brief ? 20 : 400;
  const auto columns = [](const Table::Column& knob) {
    return std::vector<Table::Column>{{"family", "Family"},
                                      {"task", "Profile"},
                                      knob,
                                      {"median_ms", "CPU ms, median"},
                                      {"median_percent", "Error, median, %"},
                                      {"worst_percent", "Worst, %"}};
  };
  Table by_tolerance("designs-profiles-tolerance", columns({"tolerance", "Tolerance of equilibria"}));
  Table by_count("designs-profiles-samples", columns({"samples", "Samples"}));
  for (const auto& space : spaces_of(settings)) {
    for (const Task task : all_tasks) {
      std::vector<Errors> of_tolerance(tolerances.size()), of_count(counts.size());
      RandomStream random("profiles " + space->model.family, 1);
      for (int i = 0; i < designs; ++i) {
        const auto parameters = random_parameters(space->model, random);
        const auto samples = samples_of(task, settings.brief ? 10 : 50);
        const Run exact = run_profile(*space, parameters, samples, tightest);
        const auto all = samples_of(task, finest);
        const Run fine = run_profile(*space, parameters, all, 1e-10);
        // Some designs have no equilibrium at one of the strains.
        if (!exact.y.allFinite() || !fine.y.allFinite()) continue;
        for (std::size_t k = 0; k < tolerances.size(); ++k) {
          const Run run = run_profile(*space, parameters, samples, tolerances[k]);
          of_tolerance[k].errors.push_back(relative_difference(run.y, exact.y));
          of_tolerance[k].seconds.push_back(run.seconds);
        }
        for (std::size_t k = 0; k < counts.size(); ++k) {
          const auto coarse = samples_of(task, counts[k]);
          const Run run = run_profile(*space, parameters, coarse, 1e-10);
          of_count[k].errors.push_back(relative_difference(interpolated(coarse, run.y, all), fine.y));
          of_count[k].seconds.push_back(run.seconds);
        }
      }
      if (of_tolerance.front().errors.empty()) continue;
      for (std::size_t k = 0; k < tolerances.size(); ++k)
        add_row(by_tolerance, *space, task, number(tolerances[k], 1), of_tolerance[k]);
      for (std::size_t k = 0; k < counts.size(); ++k)
        add_row(by_count, *space, task, std::to_string(counts[k]), of_count[k]);
    }
  }
  Report report(settings.folder, "designs-profiles", "Profiles of designs: what accuracy costs");
  report.heading("Tolerance of equilibria");
  report.text("`accuracy.equilibrium_tolerance` of profiles with 50 samples, against " + number(tightest, 1) + ".");
  report.table(by_tolerance);
  report.heading("Samples");
  report.text("Between samples a cubic spline goes through them, of period pi over directions. Its error at " +
              count(finest) + " places.");
  report.table(by_count);
  report.write(
      design_introduction(settings, "profiles",
                          "Profiles of 10 random designs of each family: stress at strains from -0.1 to 0.2 along "
                          "0.3 rad, stiffness and Poisson's ratio over half a turn at a strain of 0.05. Errors are "
                          "root mean squares relative to that of the profile. They are those of the computation; "
                          "by how much a model errs is on its card."));
}

}  // namespace supple::bench
