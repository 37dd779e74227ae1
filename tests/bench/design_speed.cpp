// What one design costs: from a given start, while a control point is dragged, and over all families.
#include <cmath>
#include <numbers>

#include "design_bench.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/error.h"

namespace supple::bench {
namespace {

/// CPU seconds of searches from a random start, one for each target of a random design.
std::vector<double> single_starts(const LoadedSpace& space, design::Task task, int designs) {
  std::vector<double> seconds;
  RandomStream random("speed " + space.model.family, static_cast<std::uint64_t>(task) + 1);
  while (static_cast<int>(seconds.size()) < designs) {
    const auto target =
        target_of(space, random_parameters(space.model, random), task, random.uniform(0, std::numbers::pi), 0.05);
    const auto start = random_parameters(space.model, random);
    if (!target) continue;
    design::DesignProblem problem{{*target}, {}, {}};
    problem.initial = Eigen::Map<const Eigen::VectorXd>(start.data(), static_cast<Eigen::Index>(start.size()));
    design::DesignOptions options;
    options.multi_start = Switch::off;
    seconds.push_back(cpu_time([&] {
      try {
        design::find_design(space.space(), problem, options);
      } catch (const Error&) {
        // A search without an equilibrium at its start counts too.
      }
    }));
  }
  return seconds;
}

/// One control point moves in small steps; each design starts from the one before, with the accuracy that the editor
/// asks for while it follows (clients/web/src/design/requests.ts).
std::vector<double> drags(const LoadedSpace& space, design::Task task, int steps) {
  std::vector<double> seconds;
  RandomStream random("drag " + space.model.family, static_cast<std::uint64_t>(task) + 1);
  std::optional<design::Target> target;
  while (!target) target = target_of(space, random_parameters(space.model, random), task, 0.4, 0.05);
  auto design = design::find_design(space.space(), {{*target}, {}, {}});
  design::DesignOptions options;
  options.multi_start = options.envelope = Switch::off;
  options.tolerance = 1e-4;
  options.max_iterations = 20;
  const auto middle = target->control_points.size() / 2;
  for (int step = 0; step < steps; ++step) {
    target->control_points[middle][1] += 0.01 * design.profiles[0].target.scale;
    const design::DesignProblem problem{{*target}, design.parameters, {}};
    seconds.push_back(cpu_time([&] { design = design::find_design(space.space(), problem, options); }));
  }
  return seconds;
}

}  // namespace

void study_design_speed(const DesignSettings& settings) {
  const int designs = settings.designs > 0 ? settings.designs : settings.brief ? 2 : 40;
  Report report(settings.folder, "designs", "speed", "Time of a design");
  const auto spaces = spaces_of(settings);
  Table table("designs-speed", {{"family", "Family"},
                                {"width", "Width"},
                                {"task", "Task"},
                                {"samples", "Samples"},
                                {"median_ms", "One start, median ms"},
                                {"p90_ms", "90th percentile ms"},
                                {"drag_ms", "While dragging, median ms"},
                                {"updates", "Updates a second"}});
  std::vector<double> medians[3];
  double slowest_drag = 0;
  for (const auto& space : spaces) {
    for (const auto task : all_tasks) {
      const auto seconds = single_starts(*space, task, designs);
      const auto dragged = drags(*space, task, settings.brief ? 2 : 20);
      medians[static_cast<int>(task)].push_back(median(seconds));
      slowest_drag = std::max(slowest_drag, median(dragged));
      table.row({space->model.family, count(space->model.network.shape.width), std::string(to_string(task)),
                 task == design::Task::stress_strain ? "10" : "50", number(1e3 * median(seconds)),
                 number(1e3 * quantile(seconds, 0.9)), number(1e3 * median(dragged)), number(1 / median(dragged))});
    }
  }
  report.table(table);
  const auto slowest = [&](int task) { return quantile(medians[task], 1); };
  report.target("10-sample stress curve, median, slowest family", "30 ms", number(1e3 * slowest(0)) + " ms",
                slowest(0) < 0.03);
  report.target("50-direction stiffness, likewise", "150 ms", number(1e3 * slowest(1)) + " ms", slowest(1) < 0.15);
  report.target("50-direction Poisson's ratio, likewise", "150 ms", number(1e3 * slowest(2)) + " ms",
                slowest(2) < 0.15);
  report.target("Updated designs a second while dragging, slowest family and task", "15", number(1 / slowest_drag),
                1 / slowest_drag >= 15);

  report.heading("Search over all families");
  Table search("designs-search",
               {{"task", "Task"}, {"families", "Families"}, {"cpu_s", "CPU s"}, {"wall_s", "Elapsed s"}});
  std::vector<design::DesignSpace> all;
  for (const auto& space : spaces) all.push_back(space->space());
  double longest = 0;
  for (const auto task : all_tasks) {
    // The mean of two families' profiles is a target that no family has.
    RandomStream random("search", static_cast<std::uint64_t>(task) + 1);
    std::optional<design::Target> a;
    std::optional<design::Target> b;
    while (!a) a = target_of(*spaces.front(), random_parameters(spaces.front()->model, random), task, 0.2, 0.05);
    while (!b) b = target_of(*spaces.back(), random_parameters(spaces.back()->model, random), task, 0.2, 0.05);
    for (std::size_t i = 0; i < a->control_points.size(); ++i)
      a->control_points[i][1] = 0.5 * (a->control_points[i][1] + b->control_points[i][1]);
    const double start = wall_seconds();
    const double cpu = cpu_time([&] { design::find_designs(all, {{*a}, {}, {}}); });
    const double elapsed = wall_seconds() - start;
    longest = std::max(longest, cpu);
    search.row({std::string(to_string(task)), count(static_cast<double>(all.size())), number(cpu), number(elapsed)});
  }
  report.table(search);
  report.target("Search over all families, CPU time", "2 s", number(longest) + " s", longest < 2);
  report.write(settings.command("speed"), settings.brief,
               "One start: targets of random designs, from one random starting point. Dragging: one control point "
               "moves by 1 % of the target's scale, and the search goes on from the design before with the accuracy "
               "that the web editor asks for meanwhile, a tolerance of 1e-4 and 20 iterations. Search: a target that "
               "lies between two families, so that every family tries all its starting points. Times are CPU times of "
               "one thread unless they are called elapsed.");
}

}  // namespace supple::bench
