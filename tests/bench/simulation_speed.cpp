// Samples per core-second of each family on the data sets' mesh, and where the time goes.
#include <algorithm>
#include <numbers>
#include <vector>

#include "measurement.h"
#include "simulation_bench.h"
#include "supple/base/random.h"
#include "supple/base/threads.h"

namespace supple::bench {
namespace {

using microscale::BiaxialLoad;
using microscale::Load;
using microscale::Simulator;
using microscale::UniaxialLoad;

/// Moderate strains: uniaxial stretches from 0.95 to 1.1, biaxial ones from 0.97 to 1.05, in random directions.
std::vector<Load> moderate_loads(RandomStream& random) {
  const auto direction = [&random] { return random.uniform(0, std::numbers::pi); };
  return {UniaxialLoad{direction(), {1.02, 1.04, 1.06, 1.08, 1.1}},
          UniaxialLoad{direction(), {0.99, 0.98, 0.97, 0.96, 0.95}},
          BiaxialLoad{direction(), {{1.01, 0.994}, {1.02, 0.988}, {1.03, 0.982}, {1.04, 0.976}, {1.05, 0.97}}},
          BiaxialLoad{direction(), {{1.01, 1.01}, {1.02, 1.02}, {1.03, 1.03}, {1.04, 1.04}, {1.05, 1.05}}},
          BiaxialLoad{direction(), {{0.994, 0.994}, {0.988, 0.988}, {0.982, 0.982}, {0.976, 0.976}, {0.97, 0.97}}}};
}

struct FamilySpeed {
  std::vector<double> nodes;
  int states = 0;
  int unreached = 0;
  int in_patch = 0;
  int touching = 0;
  int iterations = 0;
  double cpu_seconds = 0;
  double wall_seconds = 0;  ///< without meshing, as the bill counts
  double meshing_seconds = 0;
  CostLedger cost;

  double per_second() const { return states / (cpu_seconds + meshing_seconds); }
};

double contact_seconds(const CostLedger& cost) {
  return stage_seconds(cost, "contact search") + effect_seconds(cost, "contact");
}

FamilySpeed measure(const std::string& family, int designs) {
  FamilySpeed speed;
  RandomStream random("simulation_speed " + family, 1);
  for (const tiling::Structure& structure : random_structures(family, designs)) {
    const double start = cpu_seconds();
    Simulator simulator(structure, data_set_options(family));
    speed.meshing_seconds += cpu_seconds() - start;
    speed.nodes.push_back(static_cast<double>(simulator.mesh().nodes.cols()));
    for (const Load& load : moderate_loads(random)) {
      const TimedPath path = run_timed(simulator, load);
      speed.cpu_seconds += path.cpu_seconds;
      speed.wall_seconds += path.wall_seconds;
      speed.cost.merge(path.cost);
      int reached = 0;
      for (const microscale::State& state : path.result.states) {
        speed.iterations += state.iterations;
        if (state.stopped != microscale::Stop::converged) continue;
        ++reached;
        speed.in_patch += state.cells == 2;
        speed.touching += state.contacts > 0;
      }
      speed.states += reached;
      speed.unreached += microscale::size(load) - reached;
    }
  }
  return speed;
}

std::string percent_of_time(double part, double whole) { return number(100 * part / whole, 2); }

}  // namespace

void study_speed(const SimulationSettings& settings) {
  const std::vector<std::string> families =
      settings.families_or(settings.brief ? std::vector<std::string>{"IH01", "IH67"} : published_families());
  const int designs = settings.designs_or(settings.brief ? 1 : 10);
  Report report(settings.folder, "simulations", "speed", "Speed");
  Table table("simulations-speed", {{"family", "Family"},
                                    {"mesh", "Mesh"},
                                    {"nodes", "Nodes, median"},
                                    {"states", "States"},
                                    {"unreached", "Not reached"},
                                    {"in_patch", "In 2x2 cells"},
                                    {"touching", "In contact"},
                                    {"iterations", "Newton iterations per state"},
                                    {"per_second", "States per core-second"}});
  Table shares("simulations-speed-shares", {{"family", "Family"},
                                            {"ms_per_state", "ms per state"},
                                            {"meshing", "Meshing, %"},
                                            {"assembly", "Assembly, %"},
                                            {"factorization", "Factorization, %"},
                                            {"solve", "Solves, %"},
                                            {"contact", "Contact, %"},
                                            {"patch", "2x2 check, %"},
                                            {"retraction", "Turning, %"},
                                            {"other", "Other, %"}});
  // Threads that wait for others would count as CPU time.
  set_thread_count(1);
  for (const std::string& family : families) {
    const FamilySpeed speed = measure(family, designs);
    const double total = speed.cpu_seconds + speed.meshing_seconds;
    const double assembly = stage_seconds(speed.cost, "assembly");
    const double factorization = stage_seconds(speed.cost, "factorization");
    const double solve = stage_seconds(speed.cost, "solve");
    const double contact = contact_seconds(speed.cost);
    const double patch = stage_seconds(speed.cost, "patch stability");
    const double retraction = stage_seconds(speed.cost, "retraction");
    table.row({family, mesh_name(data_set_options(family).mesh), count(median(speed.nodes)),
               std::to_string(speed.states), std::to_string(speed.unreached), std::to_string(speed.in_patch),
               std::to_string(speed.touching),
               number(static_cast<double>(speed.iterations) / std::max(1, speed.states)), number(speed.per_second())});
    const double whole = speed.wall_seconds;
    shares.row({family, number(1e3 * total / std::max(1, speed.states)), percent_of_time(speed.meshing_seconds, total),
                percent_of_time(assembly, whole), percent_of_time(factorization, whole), percent_of_time(solve, whole),
                percent_of_time(contact, whole), percent_of_time(patch, whole), percent_of_time(retraction, whole),
                percent_of_time(whole - assembly - factorization - solve - contact - patch - retraction, whole)});
    const double wanted = family == "IH01" || family == "IH22" || family == "IH67" ? 10 : 4;
    report.target(family + ": states with stress and tangent per core-second", "at least " + number(wanted, 2),
                  number(speed.per_second()), speed.per_second() >= wanted);
  }
  set_thread_count(0);
  report.heading("States per core-second");
  report.table(table);
  report.heading("Where the time goes");
  report.text(
      "Meshing as a share of all CPU time; the rest as shares of the simulations' wall time, which is what the bill "
      "counts.");
  report.table(shares);
  report.write("simulation_bench speed", settings.brief,
               "The data sets' meshes (length of a side over the beam width, and the size at re-entrant corners over "
               "that elsewhere) and tolerance (1e-7). " +
                   std::to_string(designs) +
                   " random designs per family, each under five paths of five states in random directions: uniaxial "
                   "stretches to 1.1 and 0.95, biaxial ones to (1.05, 0.97), (1.05, 1.05) and (0.97, 0.97). Contact, "
                   "2x2 patch and buckling are automatic, tangents are computed; meshing counts.");
}

}  // namespace supple::bench
