// Designs found for random targets, simulated at their native scale.
#include <cmath>
#include <numbers>

#include "design_bench.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/error.h"
#include "supple/design/verification.h"
#include "supple/tiling/structure.h"

namespace supple::bench {

void study_verification(const DesignSettings& settings) {
  const int designs = settings.designs > 0 ? settings.designs : settings.brief ? 1 : 5;
  Report report(settings.folder, "designs-verification", "Inverse design: networks against simulations");
  Table table("designs-verification", {{"family", "Family"},
                                       {"task", "Task"},
                                       {"designs", "Designs"},
                                       {"median_error", "Network against simulation, median"},
                                       {"worst_error", "Worst"},
                                       {"unreached", "Samples not reached"},
                                       {"median_s", "Simulation, median elapsed s"}});
  for (const auto& space : spaces_of(settings)) {
    for (const auto task : all_tasks) {
      std::vector<double> errors;
      std::vector<double> seconds;
      int unreached = 0;
      RandomStream random("verification " + space->model.family, static_cast<std::uint64_t>(task) + 1);
      for (int i = 0; i < designs; ++i) {
        const auto parameters = random_parameters(space->model, random);
        const auto target = target_of(*space, parameters, task, random.uniform(0, std::numbers::pi), 0.05);
        if (!target) continue;
        try {
          const auto structure = tiling::make_structure(tiling::family(space->model.family), parameters);
          const auto samples = design::thinned(design::sample_target(*target).samples, settings.brief ? 2 : 8);
          microscale::SimulationOptions options;
          options.mesh.mesh_size = settings.brief ? 1 : 0.5;
          const double start = wall_seconds();
          const auto simulated = design::simulate_profile(structure, samples, options);
          seconds.push_back(wall_seconds() - start);
          const auto network = design::evaluate_profile(space->model, space->evaluator, parameters, samples);
          double difference = 0;
          double size = 1e-300;
          for (Eigen::Index k = 0; k < simulated.size(); ++k) {
            if (!std::isfinite(simulated[k])) {
              ++unreached;
              continue;
            }
            difference += std::pow(simulated[k] - network.y[k], 2);
            size += std::pow(simulated[k], 2);
          }
          errors.push_back(std::sqrt(difference / size));
        } catch (const Error& failure) {
          std::printf("%s: %s\n", space->model.family.c_str(), failure.what());
        }
      }
      if (errors.empty()) continue;
      table.row({space->model.family, std::string(to_string(task)), count(static_cast<double>(errors.size())),
                 number(median(errors)), number(quantile(errors, 1)), count(unreached), number(median(seconds))});
    }
  }
  report.table(table);
  report.write(design_introduction(
      settings, "verification",
      "Random designs within the bounds; stress from -0.1 to 0.2 of strain along a random direction, stiffness and "
      "Poisson's ratio at a strain of 0.05. Errors are root mean square differences over the simulation's root mean "
      "square."));
}

}  // namespace supple::bench
