// Elastic networks, membranes, and networks on shells and solids: accuracy against time, the time of a step, effects.
// Each study writes sections of networks.md, membranes.md or hosts.md and their CSV files, which plot.py draws.
//
//   network_bench [--short] [--out DIR] [STUDY ...]      default: all studies into docs/bench
#include "network_bench.h"

#include "command_line.h"
#include "network_hosts.h"
#include "network_membranes.h"

int main(int argc, char** argv) {
  using namespace supple::bench;
  NetworkSettings settings;
  return run_program(argc, argv, {flag("--short", settings.brief), folder_option("--out", settings.folder)},
                     {{"accuracy", [&] { study_network_accuracy(settings); }},
                      {"effects", [&] { study_network_effects(settings); }},
                      {"steps", [&] { study_network_steps(settings); }},
                      {"scenes", [&] { study_network_scenes(settings); }},
                      {"membrane-accuracy", [&] { study_membrane_accuracy(settings); }},
                      {"membrane-paths", [&] { study_membrane_paths(settings); }},
                      {"membrane-effects", [&] { study_membrane_effects(settings); }},
                      {"host-accuracy", [&] { study_host_accuracy(settings); }},
                      {"host-effects", [&] { study_host_effects(settings); }},
                      {"host-steps", [&] { study_host_steps(settings); }},
                      {"host-scenes", [&] { study_host_scenes(settings); }}});
}
