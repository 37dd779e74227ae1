// Elastic networks on surfaces: what a step costs, what accuracy costs, and how methods compare. Writes networks.md and
// CSV files; plot_networks.py draws them.
//
//   network_bench [--short] [--out DIR]      default DIR: docs/bench
#include "network_bench.h"

#include <filesystem>

#include "command_line.h"
#include "measurement.h"
#include "supple/base/threads.h"

int main(int argc, char** argv) {
  using namespace supple::bench;
  supple::set_thread_count(0);
  NetworkSettings settings;
  std::filesystem::path folder = "docs/bench";
  const auto page = [&] {
    Report report(folder, "networks", "Elastic networks on surfaces: measured times and convergence");
    measure_scenes(report, settings);
    report.write("x");
  };
  return run_program(argc, argv, {flag("--short", settings.brief), folder_option("--out", folder)},
                     {{"networks", page}});
}
