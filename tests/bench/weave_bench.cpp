// Digital weaves: accuracy of cells and of sheets against time, load steps, what cells and sheets cost, how that grows
// with a sheet, what effects cost.
//
//   weave_bench [--short] [--out DIR] [STUDY ...]      default: all studies into docs/bench
#include "weave_bench.h"

#include "command_line.h"

int main(int argc, char** argv) {
  using namespace supple::bench;
  WeaveSettings settings;
  return run_program(argc, argv, {flag("--short", settings.brief), folder_option("--out", settings.folder)},
                     {{"accuracy", [&] { study_weave_accuracy(settings); }},
                      {"sheets", [&] { study_weave_sheets(settings); }},
                      {"paths", [&] { study_weave_paths(settings); }},
                      {"speed", [&] { study_weave_speed(settings); }},
                      {"size", [&] { study_weave_size(settings); }},
                      {"effects", [&] { study_weave_effects(settings); }}});
}
