// Targets made from random designs: how often the search finds a design that has them, and at what cost.
#include <numbers>

#include "design_bench.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/error.h"

namespace supple::bench {
namespace {

struct RecoveryOutcome {
  std::vector<double> errors;
  std::vector<double> seconds;
  std::vector<double> starts;
  std::vector<double> evaluations;
  int without_target = 0;
};

double quantity(const CostLedger& bill, std::string_view name) {
  for (const auto& quantity : bill.quantities())
    if (quantity.name == name) return quantity.value;
  return 0;
}

RecoveryOutcome recover(const LoadedSpace& space, design::Task task, int designs) {
  RecoveryOutcome outcome;
  RandomStream random("recovery " + space.model.family, static_cast<std::uint64_t>(task) + 1);
  for (int i = 0; i < designs; ++i) {
    const auto parameters = random_parameters(space.model, random);
    const double direction = random.uniform(0, std::numbers::pi);
    const double strain = random.uniform(0.01, 0.1);
    const auto target = target_of(space, parameters, task, direction, strain);
    if (!target) {
      ++outcome.without_target;
      continue;
    }
    CostLedger bill;
    double error = 1;
    outcome.seconds.push_back(cpu_time([&] {
      try {
        const design::DesignProblem problem{{*target}, {}, {}};
        const auto found = design::find_design(space.space(), problem, {}, {.cost = &bill});
        error = found.error.relative_rms;
        outcome.starts.push_back(found.starts);
      } catch (const Error& failure) {
        std::printf("%s: %s\n", space.model.family.c_str(), failure.what());
      }
    }));
    outcome.errors.push_back(error);
    outcome.evaluations.push_back(quantity(bill, "evaluations"));
  }
  return outcome;
}

}  // namespace

void study_recovery(const DesignSettings& settings) {
  const int designs = settings.designs > 0 ? settings.designs : settings.brief ? 2 : 100;
  Report report(settings.folder, "designs-recovery", "Inverse design: finding known designs again");
  Table table("designs-recovery", {{"family", "Family"},
                                   {"task", "Task"},
                                   {"targets", "Targets"},
                                   {"found", "Error below 1 %"},
                                   {"median_error", "Median error"},
                                   {"worst_error", "Worst error"},
                                   {"starts", "Starts, mean"},
                                   {"evaluations", "Evaluations, mean"},
                                   {"median_ms", "Median ms"},
                                   {"p90_ms", "90th percentile ms"}});
  double worst_share = 1;
  for (const auto& space : spaces_of(settings)) {
    for (const auto task : all_tasks) {
      const auto outcome = recover(*space, task, designs);
      if (outcome.errors.empty()) continue;
      const auto found = std::count_if(outcome.errors.begin(), outcome.errors.end(), [](double e) { return e < 0.01; });
      worst_share = std::min(worst_share, static_cast<double>(found) / static_cast<double>(outcome.errors.size()));
      table.row({space->model.family, std::string(to_string(task)), count(static_cast<double>(outcome.errors.size())),
                 count(static_cast<double>(found)), number(median(outcome.errors)), number(quantile(outcome.errors, 1)),
                 number(mean(outcome.starts)), number(mean(outcome.evaluations), 4),
                 number(1e3 * median(outcome.seconds)), number(1e3 * quantile(outcome.seconds, 0.9))});
    }
  }
  report.table(table);
  report.target("Targets found again with an error below 1 %, in every family and task", "95 %",
                number(100 * worst_share) + " %", worst_share >= 0.95);
  report.write(design_introduction(settings, "recovery",
                                   "Targets are the profiles of random designs within the bounds, along random "
                                   "directions and at strains from 0.01 to "
                                   "0.1; the search knows nothing of the designs and begins with the best of a few "
                                   "dozen candidates. The error is the "
                                   "root mean square deviation over that of the target. Each target is new, so that no "
                                   "candidate is known already."));
}

}  // namespace supple::bench
