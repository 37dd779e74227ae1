// Exact geodesics against CGAL's in one run: accuracy, times, memory, effects. Each study writes a section of
// geodesics.md and its CSV files, which plot.py draws.
//
//   bench_geodesics [--short] [--out DIR] [STUDY ...]      default: all studies into docs/bench
#include "geodesic_bench.h"

#include "command_line.h"

int main(int argc, char** argv) {
  using namespace supple::bench;
  Settings settings;
  // The large mesh comes first, while the process holds nothing else.
  return run_program(argc, argv, {flag("--short", settings.brief), folder_option("--out", settings.folder)},
                     {{"large-mesh", [&] { study_large_mesh(settings); }},
                      {"accuracy", [&] { study_accuracy(settings); }},
                      {"one-to-all", [&] { study_one_to_all(settings); }},
                      {"pairs", [&] { study_pairs(settings); }},
                      {"throughput", [&] { study_throughput(settings); }},
                      {"effects", [&] { study_effects(settings); }}});
}
