// What a design does when it is simulated, and how far simulation corrects it.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "design_bench.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/error.h"
#include "supple/design/polish.h"
#include "supple/tiling/structure.h"

namespace supple::bench {
namespace {

constexpr int max_draws_per_target = 5;  ///< random designs for each target
/// The deviation that counts for a design of the search whose simulation does not reach every sample.
constexpr double unsimulated_deviation = 1;

constexpr auto conditions =
    "Targets are what random designs within the bounds do when they are simulated: stress at 10 strains from -0.1 to "
    "0.2 along a random direction, stiffness and Poisson's ratio at a strain of 0.05 in 12 directions. The network "
    "finds a "
    "design for each; then simulations correct it (`effects.polish`) until it deviates by 0.2 %, at most 30 rounds. "
    "Deviations are relative root mean squares as in answers, 0.01 is one per cent; a design of the search whose "
    "simulation does not reach every sample counts as one that deviates by 100 %. Seconds are elapsed, on two "
    "threads. Each target has a row in [designs-polish-targets.csv](designs-polish-targets.csv), with the checksum of "
    "the model's file; a run goes on from there. Times are CPU times of one thread unless they are called elapsed.";

/// Search and polish of one random design, which is not usable if it makes no target.
struct PolishOutcome {
  bool usable = false;
  double network = 0, unpolished = 0, polished = 0;
  int rounds = 0;
  double search_seconds = 0, first_seconds = 0, seconds = 0;
};

/// The outcomes of earlier runs, in a CSV file beside the page, since a run of all families takes hours. Outcomes for
/// other models stay in the file and are not used. Remove the file after a change of the search, of polish or of the
/// simulation; use `--again` after a change that concerns only targets which polish did not reach.
class SavedOutcomes {
 public:
  SavedOutcomes(std::filesystem::path file, const LoadedSpace& space, design::Task task)
      : file_(std::move(file)),
        key_(space.model.family + ',' + std::string(to_string(task)) + ',' + space.checksum + ',') {
    std::ifstream in(file_);
    for (std::string line; std::getline(in, line);) {
      if (!line.starts_with(key_)) continue;
      std::ranges::replace(line, ',', ' ');
      std::istringstream text(line.substr(key_.size()));
      PolishOutcome o;
      if (text >> o.usable >> o.network >> o.unpolished >> o.polished >> o.rounds >> o.search_seconds >>
          o.first_seconds >> o.seconds)
        outcomes_.push_back(o);
    }
  }
  std::size_t size() const { return outcomes_.size(); }
  const PolishOutcome& operator[](std::size_t i) const { return outcomes_[i]; }
  void add(const PolishOutcome& o) {
    const bool begins = !std::filesystem::exists(file_);
    std::ofstream out(file_, std::ios::app);
    if (begins) out << "family,task,model,usable,network,unpolished,polished,rounds,search_s,simulation_s,polish_s\n";
    out << row_of(o);
    outcomes_.push_back(o);
  }
  void replace(std::size_t i, const PolishOutcome& o) {
    std::ifstream in(file_);
    std::ostringstream rows;
    std::size_t place = 0;
    for (std::string line; std::getline(in, line);)
      rows << (line.starts_with(key_) && place++ == i ? row_of(o) : line + '\n');
    in.close();
    std::ofstream(file_) << rows.str();
    outcomes_[i] = o;
  }

 private:
  std::string row_of(const PolishOutcome& o) const {
    std::ostringstream row;
    row.precision(6);
    row << key_ << o.usable << ',' << o.network << ',' << o.unpolished << ',' << o.polished << ',' << o.rounds << ','
        << o.search_seconds << ',' << o.first_seconds << ',' << o.seconds << '\n';
    return row.str();
  }

  std::filesystem::path file_;
  std::string key_;
  std::vector<PolishOutcome> outcomes_;
};

PolishOutcome polish_one(const LoadedSpace& space, const design::Target& target,
                         const design::SimulateProfile& simulate, const design::PolishOptions& options) {
  auto buildable = space.space();
  buildable.buildable = [&family = tiling::family(space.model.family)](const Eigen::VectorXd& parameters) {
    return tiling::can_be_built(family, {parameters.data(), static_cast<std::size_t>(parameters.size())});
  };
  const design::DesignProblem problem{{target}, {}, {}};
  const double start = wall_seconds();
  const auto found = design::find_design(buildable, problem);
  const double searched = wall_seconds();
  const auto polished = design::polish(buildable, problem, found.parameters, simulate, options);
  const double end = wall_seconds();
  const auto& first = polished.rounds.front();
  if (!polished.target_error) return {};
  std::printf("%s %s: %.3f %% by the network, %.3f %% simulated, %.3f %% polished in %zu rounds and %.1f s (%s)\n",
              space.model.family.c_str(), to_string(target.task).data(), 100 * found.error.relative_rms,
              100 * first.target_error.value_or(unsimulated_deviation), 100 * *polished.target_error,
              polished.rounds.size() - 1, end - searched, to_string(polished.stopped).data());
  std::fflush(stdout);
  return {true,
          found.error.relative_rms,
          first.target_error.value_or(unsimulated_deviation),
          *polished.target_error,
          static_cast<int>(polished.rounds.size()) - 1,
          searched - start,
          first.seconds,
          end - searched};
}

/// Outcomes of the first random designs that make a target.
std::vector<PolishOutcome> outcomes_of(const LoadedSpace& space, design::Task task, int targets,
                                       const DesignSettings& settings) {
  SavedOutcomes saved(settings.folder / "designs-polish-targets.csv", space, task);
  RandomStream random("polish " + space.model.family, static_cast<std::uint64_t>(task) + 1);
  const auto simulate = simulation_of(space.model.family, settings);
  design::PolishOptions options;
  options.max_seconds = 3600;  // the number of rounds ends polish here, on whatever machine
  if (settings.brief) options.max_rounds = 1;
  std::vector<PolishOutcome> outcomes;
  for (std::size_t i = 0;
       static_cast<int>(outcomes.size()) < targets && i < static_cast<std::size_t>(max_draws_per_target * targets);
       ++i) {
    const bool known = i < saved.size();
    if (known && !(settings.again && saved[i].polished > options.tolerance)) {
      skip_target(space, random);
    } else {
      PolishOutcome outcome;
      try {
        if (const auto target = simulated_target(space, task, random, simulate))
          outcome = polish_one(space, *target, simulate, options);
      } catch (const Error& failure) {
        std::printf("%s: %s\n", space.model.family.c_str(), failure.what());
      }
      if (known)
        saved.replace(i, outcome);
      else
        saved.add(outcome);
    }
    if (saved[i].usable) outcomes.push_back(saved[i]);
  }
  return outcomes;
}

template <class Member>
std::vector<double> all(const std::vector<PolishOutcome>& outcomes, Member member) {
  std::vector<double> values;
  values.reserve(outcomes.size());
  for (const PolishOutcome& outcome : outcomes) values.push_back(static_cast<double>(outcome.*member));
  return values;
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
  std::filesystem::create_directories(settings.folder);
  if (settings.brief) std::filesystem::remove(settings.folder / "designs-polish-targets.csv");
  for (const auto& space : spaces_of(settings)) {
    for (const auto task : all_tasks) {
      const auto outcomes = outcomes_of(*space, task, targets, settings);
      if (outcomes.empty()) continue;
      const auto unpolished = all(outcomes, &PolishOutcome::unpolished);
      const auto polished = all(outcomes, &PolishOutcome::polished);
      table.row({space->model.family, std::string(to_string(task)), count(static_cast<double>(outcomes.size())),
                 number(mean(all(outcomes, &PolishOutcome::network))), number(median(unpolished)),
                 number(mean(unpolished)), number(quantile(unpolished, 1)), number(median(polished)),
                 number(mean(polished)), number(quantile(polished, 1)),
                 count(median(all(outcomes, &PolishOutcome::rounds))),
                 number(median(all(outcomes, &PolishOutcome::search_seconds))),
                 number(median(all(outcomes, &PolishOutcome::first_seconds))),
                 number(median(all(outcomes, &PolishOutcome::seconds)))});
    }
    // A run of all families takes hours: each family's rows are written at once.
    Report report(settings.folder, "designs", "polish", "Polish by simulation");
    report.table(table);
    report.write(settings.command("polish"), settings.brief, conditions);
  }
}

}  // namespace supple::bench
