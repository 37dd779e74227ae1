// Digital weaves: accuracy of cells against time, what cells and sheets cost, and what effects cost. Each study writes
// a section of weaves.md and its CSV files, which plot.py draws.
//
//   weave_bench [--short] [--out DIR] [STUDY ...]      default: all studies into docs/bench
#include "weave_bench.h"

#include "command_line.h"

int main(int argc, char** argv) {
  using namespace supple::bench;
  WeaveSettings settings;
  return run_program(argc, argv, {flag("--short", settings.brief), folder_option("--out", settings.folder)},
                     {{"accuracy", [&] { study_weave_accuracy(settings); }},
                      {"speed", [&] { study_weave_speed(settings); }},
                      {"effects", [&] { study_weave_effects(settings); }}});
}
