#include "uniaxial_curves.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <sstream>
#include <utility>

#include "measurement.h"
#include "simulation_bench.h"
#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/tiling/structure.h"

namespace supple::bench {
namespace {

/// Strains at 25 places from 30 % compression to 50 % tension, rest left out.
std::vector<double> stretches(bool tension) {
  std::vector<double> values;
  for (int i = 0; i < 25; ++i) {
    const double strain = -0.3 + 0.8 * i / 24;
    if (std::abs(strain) > 1e-9 && (strain > 0) == tension) values.push_back(1 + strain);
  }
  if (!tension) std::reverse(values.begin(), values.end());
  return values;
}

MaterialLoad material_load(const microscale::State& state, double direction) {
  const Eigen::Vector2d d(std::cos(direction), std::sin(direction));
  const Eigen::Vector2d m = state.deformation_gradient.partialPivLu().solve(d).normalized();
  const auto along = [&](const Eigen::Vector3d& t) {
    return m[0] * m[0] * t[0] + m[1] * m[1] * t[1] + 2 * m[0] * m[1] * t[2];
  };
  return {std::atan2(m[1], m[0]), along(state.green_strain), along(state.stress)};
}

Curve simulate(microscale::Simulator& simulator, std::vector<double> parameters, double direction) {
  Curve curve{std::move(parameters), direction, {}, 0};
  for (const bool tension : {false, true}) {
    const auto load = stretches(tension);
    microscale::SimulationResult native;
    curve.seconds += cpu_time([&] { native = simulator.run(microscale::UniaxialLoad{direction, load}); });
    for (std::size_t i = 0; i < native.states.size(); ++i) {
      if (native.states[i].stopped != microscale::Stop::converged) break;
      curve.places.push_back({load[i], material_load(native.states[i], direction)});
    }
  }
  return curve;
}

/// Curves that earlier runs have simulated, by the number of their random draw.
class SavedCurves {
 public:
  explicit SavedCurves(std::filesystem::path file) : file_(std::move(file)) {
    std::ifstream in(file_);
    for (std::string line; std::getline(in, line);) {
      std::istringstream text(line);
      int draw = 0;
      Curve curve;
      std::size_t places = 0;
      if (!(text >> draw >> curve.seconds >> places)) continue;
      curve.places.resize(places);
      for (auto& [stretch, load] : curve.places) text >> stretch >> load.direction >> load.green_strain >> load.stress;
      if (text) curves_[draw] = std::move(curve);
    }
  }

  const Curve* find(int draw) const {
    const auto found = curves_.find(draw);
    return found == curves_.end() ? nullptr : &found->second;
  }

  void add(int draw, const Curve& curve) {
    std::ofstream out(file_, std::ios::app);
    out.precision(17);
    out << draw << ' ' << curve.seconds << ' ' << curve.places.size();
    for (const auto& [stretch, load] : curve.places)
      out << ' ' << stretch << ' ' << load.direction << ' ' << load.green_strain << ' ' << load.stress;
    out << '\n';
  }

 private:
  std::filesystem::path file_;
  std::map<int, Curve> curves_;
};

}  // namespace

microscale::SimulationOptions curve_options(const std::string& family, bool brief) {
  auto options = data_set_options(family);
  if (brief) options.mesh.mesh_size = 1.5;
  options.tangents = false;
  return options;
}

DesignBox box_of(const neural::Model& model) {
  return {tiling::family(model.family), model.network.lower, model.network.upper};
}

std::vector<Curve> simulated_curves(const DesignBox& box, const microscale::SimulationOptions& options, int wanted,
                                    const std::filesystem::path& saved_file) {
  SavedCurves saved(saved_file);
  RandomStream stream("uniaxial study " + box.family.id, 1);
  std::vector<Curve> curves;
  for (int draw = 0; static_cast<int>(curves.size()) < wanted; ++draw) {
    std::vector<double> parameters;
    for (Eigen::Index k = 0; k < box.lower.size(); ++k)
      parameters.push_back(stream.uniform(box.lower[k], box.upper[k]));
    const double direction = stream.uniform(0, std::numbers::pi);
    if (const auto* known = saved.find(draw)) {
      curves.push_back(*known);
      curves.back().parameters = parameters;
      curves.back().direction = direction;
      continue;
    }
    std::optional<microscale::Simulator> simulator;
    try {
      simulator.emplace(tiling::make_structure(box.family, parameters), options);
    } catch (const Error&) {
      continue;  // no structure at these parameters
    }
    curves.push_back(simulate(*simulator, parameters, direction));
    saved.add(draw, curves.back());
  }
  return curves;
}

}  // namespace supple::bench
