// Periodic patches under load: accuracy against time, samples per second, a peer, what effects cost, mesh noise.
//
//   simulation_bench [--short] [--designs N] [--family ID ...] [--out DIR] [STUDY ...]      default: all studies into
//   docs/bench
#include "simulation_bench.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "measurement.h"

namespace {

using supple::bench::SimulationSettings;

struct Study {
  std::string name;
  std::function<void(const SimulationSettings&)> run;
};

const std::vector<Study>& studies() {
  static const std::vector<Study> all{{"refinement", supple::bench::study_refinement},
                                      {"speed", supple::bench::study_speed},
                                      {"peer", supple::bench::study_peer},
                                      {"effects", supple::bench::study_effects},
                                      {"smoothness", supple::bench::study_smoothness}};
  return all;
}

int usage() {
  std::fprintf(stderr,
               "usage: simulation_bench [--short] [--designs N] [--family ID ...] [--out DIR] [STUDY ...]\nstudies:");
  for (const Study& study : studies()) std::fprintf(stderr, " %s", study.name.c_str());
  std::fprintf(stderr, "\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  SimulationSettings settings;
  std::vector<Study> wanted;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--short") == 0) {
      settings.brief = true;
    } else if (std::strcmp(argv[i], "--designs") == 0 && i + 1 < argc) {
      settings.designs = std::atoi(argv[++i]);
    } else if (std::strcmp(argv[i], "--family") == 0 && i + 1 < argc) {
      settings.families.emplace_back(argv[++i]);
    } else if (std::strcmp(argv[i], "--out") == 0 && i + 1 < argc) {
      settings.folder = argv[++i];
    } else {
      const std::size_t before = wanted.size();
      for (const Study& study : studies())
        if (study.name == argv[i]) wanted.push_back(study);
      if (wanted.size() == before) return usage();
    }
  }
  if (wanted.empty()) wanted = studies();
  try {
    for (const Study& study : wanted) {
      const double start = supple::bench::wall_seconds();
      study.run(settings);
      std::printf("%s: %.0f s\n", study.name.c_str(), supple::bench::wall_seconds() - start);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "simulation_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
