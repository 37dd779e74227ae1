// Inverse design with the shipped models: what the accuracy of a search costs, what designs, drags and searches over
// all families cost, networks against simulations, and polish by simulation. Each study writes a section of designs.md.
//
//   design_bench [--short] [--designs N] [--family ID ...] [--again] [--models DIR] [--out DIR] [STUDY ...]
//   default: all studies into docs/bench; --again: polish once more the targets that an earlier run has missed
#include "design_bench.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "command_line.h"
#include "supple/base/error.h"
#include "supple/design/verification.h"

namespace supple::bench {

std::string DesignSettings::command(const std::string& study) const {
  return "design_bench " + (designs > 0 ? "--designs " + std::to_string(designs) + " " : "") + study;
}

LoadedSpace::LoadedSpace(const std::filesystem::path& file) : LoadedSpace(neural::read_model(file)) {
  std::ifstream in(file, std::ios::binary);
  constexpr std::streamoff digits = 8;
  in.seekg(-(digits + 1), std::ios::end);  // the last character ends the line
  checksum.resize(digits);
  in.read(checksum.data(), digits);
}

std::vector<std::unique_ptr<LoadedSpace>> spaces_of(const DesignSettings& settings) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(settings.models))
    if (entry.path().extension() == ".h5") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  const auto& wanted = settings.families;
  const auto place = [&](const std::unique_ptr<LoadedSpace>& space) {
    return std::find(wanted.begin(), wanted.end(), space->model.family);
  };
  std::vector<std::unique_ptr<LoadedSpace>> spaces;
  for (const auto& file : files) {
    auto space = std::make_unique<LoadedSpace>(file);
    const auto& family = space->model.family;
    // One small cell and one of several tiles suffice for a short run.
    if (settings.brief && wanted.empty() && family != "IH01" && family != "IH67") continue;
    if (wanted.empty() || place(space) != wanted.end()) spaces.push_back(std::move(space));
  }
  // The order is that of the command line.
  std::stable_sort(spaces.begin(), spaces.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return spaces;
}

std::vector<double> random_parameters(const neural::Model& model, RandomStream& random) {
  std::vector<double> parameters;
  for (Eigen::Index k = 0; k < model.network.lower.size(); ++k)
    parameters.push_back(random.uniform(model.network.lower[k], model.network.upper[k]));
  return parameters;
}

std::optional<design::Target> target_of(const LoadedSpace& space, const std::vector<double>& parameters,
                                        design::Task task, double direction, double strain, int directions) {
  design::Target target;
  target.task = task;
  target.direction = direction;
  target.strain = strain;
  // The control points are the samples, so that the design from which they were made has no deviation at all.
  target.interpolation = numerics::Interpolation::linear;
  const bool over_strain = task == design::Task::stress_strain;
  const int points = over_strain ? 10 : directions;
  design::ProfileSamples samples{task, direction, strain, design::StrainMeasure::green, {}};
  for (int i = 0; i < points; ++i)
    samples.x.push_back(over_strain ? -0.1 + 0.3 * i / (points - 1) : std::numbers::pi * i / points);
  const auto profile = design::evaluate_profile(space.model, space.evaluator, parameters, samples);
  if (!profile.y.allFinite()) return std::nullopt;
  for (int i = 0; i < points; ++i)
    target.control_points.emplace_back(samples.x[static_cast<std::size_t>(i)], profile.y[i]);
  return target;
}

design::SimulateProfile simulation_of(const std::string& family, const DesignSettings& settings) {
  auto options = design::verification_options();
  if (settings.brief) options.refinement = microscale::Refinement::off;
  return design::simulation_of(tiling::family(family), options);
}

namespace {

struct RandomDesign {
  std::vector<double> parameters;
  double direction;
};
RandomDesign random_design(const LoadedSpace& space, RandomStream& random) {
  auto parameters = random_parameters(space.model, random);
  return {std::move(parameters), random.uniform(0, std::numbers::pi)};
}

}  // namespace

void skip_target(const LoadedSpace& space, RandomStream& random) { random_design(space, random); }

std::optional<design::Target> simulated_target(const LoadedSpace& space, design::Task task, RandomStream& random,
                                               const design::SimulateProfile& simulate) {
  const auto [parameters, direction] = random_design(space, random);
  try {
    auto target = target_of(space, parameters, task, direction, 0.05, 12);
    if (!target) return std::nullopt;
    target->samples = static_cast<int>(target->control_points.size());
    const Eigen::VectorXd all =
        Eigen::Map<const Eigen::VectorXd>(parameters.data(), static_cast<Eigen::Index>(parameters.size()));
    const auto y = simulate(all, design::sample_target(*target).samples, {});
    if (!y.allFinite()) return std::nullopt;
    for (Eigen::Index i = 0; i < y.size(); ++i) target->control_points[static_cast<std::size_t>(i)][1] = y[i];
    return target;
  } catch (const Error& failure) {
    std::printf("%s: %s\n", space.model.family.c_str(), failure.what());
    return std::nullopt;
  }
}

}  // namespace supple::bench

int main(int argc, char** argv) {
  using namespace supple::bench;
  DesignSettings settings;
  return run_program(argc, argv,
                     {flag("--short", settings.brief), number_option("--designs", settings.designs),
                      list_option("--family", settings.families), flag("--again", settings.again),
                      folder_option("--models", settings.models), folder_option("--out", settings.folder)},
                     {{"accuracy", [&] { study_design_accuracy(settings); }},
                      {"speed", [&] { study_design_speed(settings); }},
                      {"verification", [&] { study_verification(settings); }},
                      {"polish", [&] { study_polish(settings); }}});
}
