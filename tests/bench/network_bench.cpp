// Elastic networks on surfaces: what a step costs, what accuracy costs, and how methods compare. Writes CSV files and,
// where every study ran, networks.md; plot_networks.py, plot_membranes.py and plot_hosts.py draw them.
//
// The studies `membranes` and `hosts` write pages of their own, membranes.md and hosts.md.
//
//   network_bench [--short] [--out DIR] [STUDY ...]      default: all studies into docs/bench
#include "network_bench.h"

#include <filesystem>
#include <optional>

#include "command_line.h"
#include "measurement.h"
#include "network_hosts.h"
#include "network_membranes.h"
#include "supple/base/threads.h"

namespace {

/// What a page says before its tables; `studies` are named on the command line that makes it, `script` draws it.
std::string introduction(const supple::bench::NetworkSettings& settings, const std::string& studies,
                         const std::string& script) {
  std::string text =
      "This page is generated; how the method works is in [networks](../networks.md). Measured on: " +
      supple::bench::machine_line() +
      ".\n\n```\ncmake --preset bench && cmake --build --preset bench --target network_bench\n"
      "build/bench/tests/bench/network_bench --out docs/bench" +
      studies + "\ntests/bench/" + script +
      " docs/bench\n```\n\n"
      "*CPU ms* are of the process with one thread, which other programs on the machine disturb little; *wall ms* are "
      "with two threads, which they disturb much. Both are the best of several runs. A target on two cores is met "
      "where "
      "either is below it. *h* is the mean edge length, *D* the diagonal of the "
      "mesh's "
      "bounding box, |g| the norm of the energy's gradient by tangent coordinates of the free points.";
  if (settings.brief) text += "\n\n**A short run on small meshes: it shows that the program works, no more.**";
  return text;
}

void write_page_of_membranes(const std::filesystem::path& folder, const supple::bench::NetworkSettings& settings) {
  supple::bench::Report report(folder, "membranes", "Membranes on surfaces: measured times and convergence");
  supple::bench::measure_stretched_torus(report, settings);
  supple::bench::measure_long_descents(report, settings);
  supple::bench::measure_accuracy_of_membranes(report, settings);
  report.write(introduction(settings, " membranes", "plot_membranes.py"));
}

void write_page_of_hosts(const std::filesystem::path& folder, const supple::bench::NetworkSettings& settings) {
  supple::bench::Report report(folder, "hosts", "Hosts that give way: measured times and convergence");
  supple::bench::measure_host_scenes(report, settings);
  supple::bench::measure_host_steps(report, settings);
  supple::bench::measure_host_accuracy(report, settings);
  supple::bench::measure_host_effects(report, settings);
  report.write(introduction(settings, " hosts", "plot_hosts.py"));
}

}  // namespace

int main(int argc, char** argv) {
  using namespace supple::bench;
  NetworkSettings settings;
  std::filesystem::path folder = "docs/bench";
  std::optional<Report> report;
  std::size_t ran = 0;
  std::vector<Study> studies;
  const auto add = [&](const char* name, void (*measure)(Report&, const NetworkSettings&)) {
    studies.push_back({name, [&, measure] {
                         if (!report)
                           report.emplace(folder, "networks", "Elastic networks: measured times and convergence");
                         supple::set_thread_count(0);
                         measure(*report, settings);
                         ++ran;
                       }});
  };
  add("steps", measure_steps);
  add("scenes", measure_scenes);
  add("methods", measure_methods);
  add("accuracy", measure_accuracy_of_networks);
  add("straight", measure_straight_springs);
  add("mollifier", measure_mollified_networks);
  add("vertices", draw_kinds_of_vertices);
  const std::size_t of_networks = studies.size();
  studies.push_back({"membranes", [&] { write_page_of_membranes(folder, settings); }});
  studies.push_back({"hosts", [&] { write_page_of_hosts(folder, settings); }});
  const int status =
      run_program(argc, argv, {flag("--short", settings.brief), folder_option("--out", folder)}, studies);
  if (status == 0 && ran == of_networks) report->write(introduction(settings, "", "plot_networks.py"));
  return status;
}
