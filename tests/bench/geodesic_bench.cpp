// Exact geodesics against CGAL's in one run: times, memory, accuracy. Writes geodesics.md and CSV files. What the
// mollifier costs in accuracy is a page of its own, geodesics-mollifier.md, and so are parts from CAD programs,
// geodesics-parts.md.
//
//   bench_geodesics [--short] [--out DIR] [geodesics] [mollifier] [parts]      default DIR: docs/bench
#include "geodesic_bench.h"

#include <filesystem>
#include <string>

#include "command_line.h"
#include "measurement.h"

namespace {

void run(const std::filesystem::path& folder, const supple::bench::Settings& settings) {
  using namespace supple::bench;
  Report report(folder, "geodesics", "Geodesics: measured times, memory and accuracy");
  // Memory first, while the process holds nothing else.
  measure_large_mesh(report, settings);
  measure_memory(report, settings);
  measure_one_to_all(report, settings);
  measure_far_pairs(report, settings);
  measure_near_pairs(report, settings);
  measure_springs(report, settings);
  measure_throughput(report, settings);
  measure_accuracy(report, settings);
  measure_effects(report, settings);
  measure_order(report, settings);
  std::string introduction =
      "This page is generated; how the method works is in [geodesics](../geodesics.md). Measured on: " +
      machine_line() +
      ".\n\n```\ncmake --preset bench && cmake --build --preset bench --target bench_geodesics\n"
      "build/bench/tests/bench/bench_geodesics --out docs/bench\n"
      "tests/bench/plot_geodesics.py docs/bench\n```\n\n"
      "Times are process CPU time of one thread unless a table says otherwise; ours and CGAL's "
      "(`Surface_mesh_shortest_path`, kernel `Exact_predicates_inexact_constructions_kernel`) alternate within one "
      "run on the same inputs, and ratios are medians of the ratios of each repetition. The machine is not idle: gaps "
      "below 1.5 times mean little. *h* is the mean edge length.";
  if (settings.brief) introduction += "\n\n**A short run on small meshes: it shows that the program works, no more.**";
  report.write(introduction);
}

void run_mollifier(const std::filesystem::path& folder, const supple::bench::Settings& settings) {
  using namespace supple::bench;
  Report report(folder, "geodesics-mollifier", "Geodesics: the mollifier's accuracy against its smoothing length");
  measure_mollifier(report, settings);
  report.write("This page is generated; what the mollifier does is in [geodesics](../geodesics.md). Measured on: " +
               machine_line() +
               ".\n\n```\ncmake --preset bench && cmake --build --preset bench --target bench_geodesics\n"
               "build/bench/tests/bench/bench_geodesics mollifier --out docs/bench\n```" +
               (settings.brief ? "\n\n**A short run: it shows that the program works, no more.**" : ""));
}

void run_parts(const std::filesystem::path& folder, const supple::bench::Settings& settings) {
  using namespace supple::bench;
  Report report(folder, "geodesics-parts", "Geodesics on parts from CAD programs");
  measure_parts(report, settings);
  report.write("This page is generated; how the method works is in [geodesics](../geodesics.md). Measured on: " +
               machine_line() +
               ".\n\n```\ncmake --preset bench && cmake --build --preset bench --target bench_geodesics\n"
               "build/bench/tests/bench/bench_geodesics parts --out docs/bench\n```" +
               (settings.brief ? "\n\n**A short run: it shows that the program works, no more.**" : ""));
}

}  // namespace

int main(int argc, char** argv) {
  using namespace supple::bench;
  Settings settings;
  std::filesystem::path folder = "docs/bench";
  return run_program(argc, argv, {flag("--short", settings.brief), folder_option("--out", folder)},
                     {{"geodesics", [&] { run(folder, settings); }},
                      {"mollifier", [&] { run_mollifier(folder, settings); }},
                      {"parts", [&] { run_parts(folder, settings); }}});
}
