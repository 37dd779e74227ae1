// Profiles of random designs by the networks and by simulation at their native scale.
#include <cmath>
#include <numbers>

#include "design_bench.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/error.h"
#include "supple/design/verification.h"
#include "supple/tiling/structure.h"

namespace supple::bench {
namespace {

/// A random design within the bounds and its simulated profile.
struct Simulated {
  std::vector<double> parameters;
  design::ProfileSamples samples;
  Eigen::VectorXd y;  ///< NaN for samples that the simulation did not reach
};

/// The simulations of one task and family.
struct Truth {
  std::vector<Simulated> designs;
  std::vector<double> seconds;  ///< elapsed
  int unreached = 0;            ///< number of samples
};

Truth simulate(const LoadedSpace& space, design::Task task, int designs, const DesignSettings& settings) {
  Truth truth;
  RandomStream random("verification " + space.model.family, static_cast<std::uint64_t>(task) + 1);
  for (int i = 0; static_cast<int>(truth.designs.size()) < designs && i < max_draws_per_design * designs; ++i) {
    const auto parameters = random_parameters(space.model, random);
    const auto target = target_of(space, parameters, task, random.uniform(0, std::numbers::pi), 0.05);
    if (!target) continue;
    try {
      const auto structure = tiling::make_structure(tiling::family(space.model.family), parameters);
      const auto samples = design::coarsened(design::sample_target(*target), settings.brief ? 2 : 8).samples;
      microscale::SimulationOptions options;
      options.mesh.mesh_size = settings.brief ? 1 : 0.5;
      const double start = wall_seconds();
      truth.designs.push_back({parameters, samples, design::simulate_profile(structure, samples, options)});
      truth.seconds.push_back(wall_seconds() - start);
      truth.unreached += static_cast<int>(truth.designs.back().y.array().isNaN().count());
      std::printf("%s %s: %zu of %d designs simulated\n", space.model.family.c_str(), to_string(task).data(),
                  truth.designs.size(), designs);
      std::fflush(stdout);
    } catch (const Error& failure) {
      std::printf("%s: %s\n", space.model.family.c_str(), failure.what());
    }
  }
  return truth;
}

/// CPU seconds of finding each design again from the profile that the network has of it.
std::vector<double> search_seconds(const LoadedSpace& space, design::Task task, const Truth& truth) {
  std::vector<double> seconds;
  for (const auto& design : truth.designs) {
    const auto target = target_of(space, design.parameters, task, design.samples.direction, 0.05);
    if (target) seconds.push_back(cpu_time([&] { design::find_design(space.space(), {{*target}, {}, {}}); }));
  }
  return seconds;
}

}  // namespace

void study_verification(const DesignSettings& settings) {
  const int designs = settings.designs > 0 ? settings.designs : settings.brief ? 1 : 5;
  Report report(settings.folder, "designs", "verification", "Networks against simulations");
  Table table("designs-verification", {{"family", "Family"},
                                       {"width", "Width"},
                                       {"model_error", "Mean error of its stress, as its card says"},
                                       {"task", "Task"},
                                       {"designs", "Designs"},
                                       {"median_error", "Network against simulation, median"},
                                       {"worst_error", "Worst"},
                                       {"unreached", "Samples not reached"},
                                       {"search_ms", "Search, median ms"},
                                       {"median_s", "Simulation, median elapsed s"}});
  for (const auto& space : spaces_of(settings)) {
    for (const auto task : all_tasks) {
      const Truth truth = simulate(*space, task, designs, settings);
      std::vector<double> errors;
      for (const auto& design : truth.designs) {
        const auto network =
            design::evaluate_profile(space->model, space->evaluator, design.parameters, design.samples);
        if (const auto error = design::relative_difference(design.y, network.y)) errors.push_back(*error);
      }
      const auto searches = search_seconds(*space, task, truth);
      if (errors.empty() || searches.empty()) continue;
      table.row({space->model.family, count(space->model.network.shape.width),
                 number(neural::mean_stress_error(space->model).value_or(std::nan(""))), std::string(to_string(task)),
                 count(static_cast<double>(errors.size())), number(median(errors)), number(quantile(errors, 1)),
                 count(truth.unreached), number(1e3 * median(searches)), number(median(truth.seconds))});
    }
  }
  report.table(table);
  report.write(
      settings.command("verification"), settings.brief,
      "Random designs within the bounds. Stress from -0.1 to 0.2 of strain along a random direction, stiffness "
      "and Poisson's ratio at a strain of 0.05, at up to eight of the samples. Errors are root mean square "
      "differences over the simulation's root mean square; a search finds the design again from the network's "
      "own profile of it. Times are CPU times of one thread unless they are called elapsed.");
}

}  // namespace supple::bench
