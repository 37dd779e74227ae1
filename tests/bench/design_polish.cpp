// What a design does when it is simulated, and how far simulation corrects it.
#include "design_bench.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/error.h"
#include "supple/design/polish.h"
#include "supple/tiling/structure.h"

namespace supple::bench {
namespace {

constexpr int most_draws = 5;  ///< of random parameters, for each target wanted

constexpr auto introduction =
    "Targets are what random designs within the bounds do when they are simulated: stress at 10 strains from -0.1 to "
    "0.2 "
    "along a random direction, stiffness and Poisson's ratio at a strain of 0.05 in 12 directions. The network finds a "
    "design for each; then simulations correct it (`effects.polish`) until it deviates by 0.2 %, at most 30 rounds. "
    "Deviations are relative root mean squares as in answers, 0.01 is one per cent. Seconds are elapsed, on two "
    "threads.";

struct Outcome {
  std::vector<double> network, unpolished, polished, rounds, search_seconds, first_seconds, seconds;
};

Outcome design_again(const LoadedSpace& space, design::Task task, int targets, const DesignSettings& settings) {
  Outcome outcome;
  RandomStream random("polish " + space.model.family, static_cast<std::uint64_t>(task) + 1);
  const auto simulate = simulation_of(space.model.family, settings);
  design::PolishOptions options;
  options.max_seconds = 3600;  // what rounds come to is the question here, on whatever machine
  if (settings.brief) options.max_rounds = 1;
  for (int i = 0; static_cast<int>(outcome.network.size()) < targets && i < most_draws * targets; ++i) {
    const auto target = simulated_target(space, task, random, simulate);
    if (!target) continue;
    const design::DesignProblem problem{{*target}, {}, {}};
    try {
      auto buildable = space.space();
      buildable.buildable = [&family = tiling::family(space.model.family)](const Eigen::VectorXd& parameters) {
        return tiling::can_be_built(family, {parameters.data(), static_cast<std::size_t>(parameters.size())});
      };
      const double start = wall_seconds();
      const auto found = design::find_design(buildable, problem);
      const double searched = wall_seconds();
      const auto polished = design::polish(buildable, problem, found.parameters, simulate, options);
      const double end = wall_seconds();
      if (!polished.target_error) continue;
      outcome.network.push_back(found.error.relative_rms);
      outcome.unpolished.push_back(*polished.rounds.front().target_error);
      outcome.polished.push_back(*polished.target_error);
      outcome.rounds.push_back(static_cast<double>(polished.rounds.size()) - 1);
      outcome.search_seconds.push_back(searched - start);
      outcome.first_seconds.push_back(polished.rounds.front().seconds);
      outcome.seconds.push_back(end - searched);
      std::printf("%s %s: %.3f %% by the network, %.3f %% simulated, %.3f %% polished in %zu rounds and %.1f s (%s)\n",
                  space.model.family.c_str(), to_string(task).data(), 100 * found.error.relative_rms,
                  100 * outcome.unpolished.back(), 100 * outcome.polished.back(), polished.rounds.size() - 1,
                  outcome.seconds.back(), to_string(polished.stopped).data());
      std::fflush(stdout);
    } catch (const Error& failure) {
      std::printf("%s: %s\n", space.model.family.c_str(), failure.what());
    }
  }
  return outcome;
}

}  // namespace

void study_polish(const DesignSettings& settings) {
  const int targets = settings.designs > 0 ? settings.designs : settings.brief ? 1 : 10;
  Table table("designs-polish", {{"family", "Family"},
                                 {"task", "Task"},
                                 {"targets", "Targets"},
                                 {"network_mean", "Network against target, mean"},
                                 {"unpolished_median", "Simulation against target, median"},
                                 {"unpolished_mean", "Mean"},
                                 {"unpolished_worst", "Worst"},
                                 {"polished_median", "Polished, median"},
                                 {"polished_mean", "Mean"},
                                 {"polished_worst", "Worst"},
                                 {"rounds", "Rounds, median"},
                                 {"search_s", "Search, median s"},
                                 {"simulation_s", "One simulation, median s"},
                                 {"polish_s", "Polish, median s"}});
  // Simulations take long: what families before came to stays where a run is given up.
  const auto write_page = [&] {
    Report report(settings.folder, "designs-polish", "Inverse design: the last word to the simulation");
    report.table(table);
    report.write(design_introduction(settings, "polish", introduction));
  };
  for (const auto& space : spaces_of(settings)) {
    for (const auto task : all_tasks) {
      const Outcome outcome = design_again(*space, task, targets, settings);
      if (outcome.network.empty()) continue;
      table.row({space->model.family, std::string(to_string(task)), count(static_cast<double>(outcome.network.size())),
                 number(mean(outcome.network)), number(median(outcome.unpolished)), number(mean(outcome.unpolished)),
                 number(quantile(outcome.unpolished, 1)), number(median(outcome.polished)),
                 number(mean(outcome.polished)), number(quantile(outcome.polished, 1)), count(median(outcome.rounds)),
                 number(median(outcome.search_seconds)), number(median(outcome.first_seconds)),
                 number(median(outcome.seconds))});
    }
    write_page();
  }
}

}  // namespace supple::bench
