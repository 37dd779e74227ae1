// What accuracy costs in time: samples, tolerance, starting points, candidates.
#include <cmath>
#include <functional>
#include <numbers>

#include "design_bench.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/error.h"

namespace supple::bench {
namespace {

/// Directions of the targets; each smaller number of samples is a part of them.
constexpr int all_directions = 100;

struct Setting {
  std::string knob;
  std::string value;
  std::function<void(design::Target&, design::DesignOptions&)> apply;
};

std::vector<Setting> all_settings() {
  std::vector<Setting> all;
  for (const int n : {4, 10, 25, 50, all_directions})
    all.push_back({"samples", std::to_string(n), [n](auto& target, auto&) { target.samples = n; }});
  for (const double t : {1e-2, 1e-4, 1e-6, 1e-8})
    all.push_back({"tolerance", number(t), [t](auto&, auto& options) { options.tolerance = t; }});
  for (const double t : {1e-4, 1e-6, 1e-10, 1e-12})
    all.push_back(
        {"equilibrium_tolerance", number(t), [t](auto&, auto& options) { options.equilibrium_tolerance = t; }});
  for (const int n : {1, 2, 4, 8, 16, 24})
    all.push_back({"starts", std::to_string(n), [n](auto&, auto& options) { options.starts = n; }});
  for (const int n : {4, 16, 64, 256})
    all.push_back({"candidates", std::to_string(n), [n](auto&, auto& options) { options.candidates = n; }});
  return all;
}

}  // namespace

void study_design_accuracy(const DesignSettings& settings) {
  const int designs = settings.designs > 0 ? settings.designs : settings.brief ? 1 : 25;
  Report report(settings.folder, "designs", "accuracy", "Error against time of a search");
  Table table("designs-accuracy", {{"family", "Family"},
                                   {"knob", "Knob"},
                                   {"value", "Value"},
                                   {"found", "Error below 1 %"},
                                   {"median_error", "Median error"},
                                   {"p90_error", "90th percentile error"},
                                   {"median_ms", "Median ms"}});
  for (const auto& space : spaces_of(settings)) {
    for (const auto& setting : all_settings()) {
      std::vector<double> errors;
      std::vector<double> seconds;
      RandomStream random("accuracy " + space->model.family, 1);
      for (int i = 0; i < designs; ++i) {
        const auto parameters = random_parameters(space->model, random);
        auto target = target_of(*space, parameters, design::Task::stiffness, 0, 0.05, all_directions);
        if (!target) continue;
        target->samples = all_directions;
        const auto truth = design::sample_target(*target);
        target->samples = 50;
        design::DesignOptions options;
        setting.apply(*target, options);
        try {
          design::Design found;
          seconds.push_back(cpu_time([&] {
            found = design::find_design(space->space(), {{*target}, {}, {}}, options);
          }));
          // All directions count, however many the search has compared.
          const auto profile = design::evaluate_profile(
              space->model, space->evaluator, std::vector<double>(found.parameters.begin(), found.parameters.end()),
              truth.samples);
          errors.push_back(std::sqrt(truth.weights.dot(truth.deviations(profile.y).cwiseAbs2())) / truth.scale);
        } catch (const Error&) {
          errors.push_back(1);
        }
      }
      if (errors.empty() || seconds.empty()) continue;
      const auto found = std::count_if(errors.begin(), errors.end(), [](double e) { return e < 0.01; });
      table.row({space->model.family, setting.knob, setting.value, count(static_cast<double>(found)),
                 number(median(errors)), number(quantile(errors, 0.9)), number(1e3 * median(seconds))});
    }
  }
  report.table(table);
  report.write(settings.command("accuracy"), settings.brief,
               "Stiffness over 100 directions of random designs at a strain of 0.05, found again with one setting "
               "changed at a time from the defaults (50 samples, tolerance 1e-6, equilibria to 1e-10, 24 starts, 40 "
               "candidates for each parameter). Times are CPU times of one thread.");
}

}  // namespace supple::bench
