// Periodic patches under load: accuracy against time, samples per second, what effects cost, and a peer.
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
                      {"discretization", [&] { study_discretization(settings); }},
                      {"speed", [&] { study_speed(settings); }},
                      {"effects", [&] { study_effects(settings); }},
                      {"peer", [&] { study_peer(settings); }}});
}
