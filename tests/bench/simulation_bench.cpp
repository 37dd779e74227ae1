// Periodic patches under load: accuracy against time, samples per second, a peer, what effects cost, mesh noise.
//
//   simulation_bench [--short] [--designs N] [--family ID ...] [--out DIR] [STUDY ...]      default: all studies into
//   docs/bench
#include "simulation_bench.h"

#include "command_line.h"

int main(int argc, char** argv) {
  using namespace supple::bench;
  SimulationSettings settings;
  return run_program(argc, argv,
                     {flag("--short", settings.brief), number_option("--designs", settings.designs),
                      list_option("--family", settings.families), folder_option("--out", settings.folder)},
                     {{"accuracy", [&] { study_simulation_accuracy(settings); }},
                      {"refinement", [&] { study_refinement(settings); }},
                      {"speed", [&] { study_speed(settings); }},
                      {"peer", [&] { study_peer(settings); }},
                      {"effects", [&] { study_effects(settings); }},
                      {"discretization", [&] { study_discretization(settings); }},
                      {"smoothness", [&] { study_smoothness(settings); }}});
}
