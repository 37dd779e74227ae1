// Inverse design over the network against searches whose every look at a design is a simulation (thesis 4.4.3).
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "design_bench.h"
#include "measurement.h"
#include "morphed_mesh.h"
#include "report.h"
#include "supple/base/error.h"
#include "supple/base/threads.h"
#include "supple/design/polish.h"
#include "supple/design/verification.h"
#include "supple/numerics/bounded_least_squares.h"
#include "supple/tiling/structure.h"

namespace supple::bench {
namespace {

/// Steps of differences, as shares of a parameter's range: the thesis's figure 4.12; one that rises above what meshes
/// shake by, some 1e-4 of the response; and one for a mesh that keeps its triangles, which does not shake.
constexpr double short_step = 1e-6;
constexpr double long_step = 5e-3;
constexpr double kept_mesh_step = 1e-4;
/// Where all searches that simulate end.
constexpr double close_enough = 1e-3;
constexpr double found_within = 0.01;
constexpr int most_attempts = 8;  ///< of random targets and starts, for each target wanted

struct NativeSettings {
  int targets = 3;
  int budget = 60;  ///< simulations of one search at most
  int polish_rounds = 30;
  microscale::SimulationOptions simulation;
};

NativeSettings native_settings(const DesignSettings& settings) {
  NativeSettings native;
  if (settings.brief) native = {.targets = 1, .budget = 4, .polish_rounds = 1, .simulation = {}};
  if (settings.designs > 0) native.targets = settings.designs;
  native.simulation = design::verification_options();
  if (settings.brief) native.simulation.mesh.mesh_size = 1;
  return native;
}

std::span<const double> span_of(const Eigen::VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

/// design::simulate_profile of a mesh at hand, for stress over Green strain.
Eigen::VectorXd profile_of_mesh(const tiling::PeriodicMesh& cell, const design::ProfileSamples& samples,
                                microscale::SimulationOptions options) {
  options.tangents = false;
  const auto index_of = [](std::size_t i) { return static_cast<Eigen::Index>(i); };
  Eigen::VectorXd y = Eigen::VectorXd::Constant(index_of(samples.x.size()), std::nan(""));
  // Tension and compression are a path each, away from rest.
  parallel_for(2, [&](int side) {
    std::vector<std::size_t> path;
    path.reserve(samples.x.size());
    for (std::size_t i = 0; i < samples.x.size(); ++i)
      if ((samples.x[i] >= 0) == (side == 0)) path.push_back(i);
    if (path.empty()) return;
    std::sort(path.begin(), path.end(),
              [&](std::size_t a, std::size_t b) { return std::abs(samples.x[a]) < std::abs(samples.x[b]); });
    microscale::UniaxialLoad load{samples.direction, {}, microscale::LoadFrame::material};
    load.stretches.reserve(path.size());
    for (const std::size_t i : path) load.stretches.push_back(std::sqrt(1 + 2 * samples.x[i]));
    microscale::Simulator simulator(cell, options);
    const auto result = simulator.run(load);
    for (std::size_t k = 0; k < result.states.size(); ++k) {
      const auto& state = result.states[k];
      if (state.stopped != microscale::Stop::converged) continue;
      y[index_of(path[k])] = design::profile_value(samples.task, samples.measure, samples.direction, samples.x[path[k]],
                                                   state.stress, state.tangent);
    }
  });
  return y;
}

/// The deviation of the simulated profile from a target, with derivatives by differences of whole simulations.
class NativeResiduals : public numerics::ResidualFunction {
 public:
  struct Differences {
    double step = 0;         ///< share of a parameter's range
    bool keep_mesh = false;  ///< simulate them on the design's own mesh, morphed
  };

  NativeResiduals(const tiling::Family& family, const design::SampledTarget& target, const neural::Network& box,
                  const NativeSettings& native, Differences differences)
      : family_(family), target_(target), box_(box), native_(native), differences_(differences) {}

  bool residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) override {
    std::optional<Shape> shape;
    const auto values = simulated([&] {
      shape = shape_of(x);
      return shape->cell;
    });
    if (!values) return false;
    shape_ = std::move(shape);
    x_ = x;
    r_ = deviations(*values);
    r = r_;
    return true;
  }

  void jacobian(Eigen::MatrixXd& jacobian) override {
    jacobian.setZero(r_.size(), x_.size());
    if (r_.norm() <= close_enough) return;  // the search ends here
    for (Eigen::Index k = 0; k < x_.size(); ++k) {
      // Backwards where there is no way forwards. Without either, or a simulation left, the parameter counts as one
      // that changes nothing.
      for (const double sign : {1.0, -1.0}) {
        Eigen::VectorXd x = x_;
        x[k] += sign * differences_.step * (box_.upper[k] - box_.lower[k]);
        if (x[k] < box_.lower[k] || x[k] > box_.upper[k]) continue;
        const auto values = simulated([&] { return cell_at(x); });
        if (!values) continue;
        jacobian.col(k) = (deviations(*values) - r_) / (x[k] - x_[k]);
        break;
      }
    }
  }

  int simulations() const { return simulations_; }
  int remeshed() const { return remeshed_; }

 private:
  struct Shape {
    tiling::Structure structure;
    tiling::PeriodicMesh cell;
  };

  Shape shape_of(const Eigen::VectorXd& x) const {
    auto structure = tiling::make_structure(family_, span_of(x));
    auto cell = tiling::mesh_structure(structure, native_.simulation.mesh);
    return {std::move(structure), std::move(cell)};
  }

  tiling::PeriodicMesh cell_at(const Eigen::VectorXd& x) {
    if (differences_.keep_mesh) {
      if (auto cell = morphed(shape_->cell, shape_->structure, tiling::make_structure(family_, span_of(x))))
        return *std::move(cell);
      ++remeshed_;
    }
    return shape_of(x).cell;
  }

  /// Nothing where there is no such structure, it cannot be simulated at every sample, or the budget is spent.
  template <class MakeCell>
  std::optional<Eigen::VectorXd> simulated(const MakeCell& make_cell) {
    if (simulations_ >= native_.budget) return std::nullopt;
    ++simulations_;
    try {
      Eigen::VectorXd values = profile_of_mesh(make_cell(), target_.samples, native_.simulation);
      if (!values.allFinite()) return std::nullopt;
      return values;
    } catch (const Error& failure) {
      if (!failure.code().starts_with("tiling.") && !failure.code().starts_with("simulation.")) throw;
      return std::nullopt;
    }
  }

  /// Their norm is SampledTarget::relative_rms.
  Eigen::VectorXd deviations(const Eigen::VectorXd& values) const {
    return target_.weights.cwiseSqrt().cwiseProduct(target_.deviations(values)) / target_.scale;
  }

  const tiling::Family& family_;
  const design::SampledTarget& target_;
  const neural::Network& box_;
  const NativeSettings& native_;
  const Differences differences_;
  std::optional<Shape> shape_;
  Eigen::VectorXd x_;
  Eigen::VectorXd r_;
  int simulations_ = 0;
  int remeshed_ = 0;  ///< differences for which the mesh could not be kept
};

/// What one method came to for one target.
struct Attempt {
  double deviation = 0;
  int simulations = 0;
  double seconds = 0;
  double cpu = 0;
};

struct Method {
  std::string name;
  std::vector<Attempt> attempts{};

  std::vector<double> all(double Attempt::*value) const {
    std::vector<double> values;
    values.reserve(attempts.size());
    for (const Attempt& attempt : attempts) values.push_back(attempt.*value);
    return values;
  }
  double within(double deviation) const {
    return static_cast<double>(std::count_if(attempts.begin(), attempts.end(), [deviation](const Attempt& attempt) {
      return attempt.deviation <= deviation;
    }));
  }
  double simulations() const {
    std::vector<double> values;
    values.reserve(attempts.size());
    for (const Attempt& attempt : attempts) values.push_back(attempt.simulations);
    return median(values);
  }
};

std::vector<Method> all_methods() {
  return {{"network, from the start"},
          {"network, with its own starts"},
          {"network and polish"},
          {"simulation, differences over 1e-6"},
          {"simulation, differences over 5e-3"},
          {"simulation, differences over 1e-4 on one mesh"}};
}

/// All methods for one target from one start, in the order of all_methods(). Throws where one of them has no answer.
class Race {
 public:
  Race(const LoadedSpace& space, const DesignSettings& settings, const design::Target& target, Eigen::VectorXd start)
      : space_(space),
        family_(tiling::family(space.model.family)),
        native_(native_settings(settings)),
        target_(target),
        sampled_(design::sample_target(target)),
        start_(std::move(start)),
        simulate_(design::simulation_of(family_, native_.simulation)) {
    buildable_.buildable = [this](const Eigen::VectorXd& x) { return tiling::can_be_built(family_, span_of(x)); };
  }

  double deviation(const Eigen::VectorXd& x) const {
    return sampled_.relative_rms(simulate_(x, sampled_.samples, {})).value_or(std::nan(""));
  }

  std::vector<Attempt> run() {
    return {network_alone(),
            network(false),
            network(true),
            native({short_step, false}),
            native({long_step, false}),
            native({kept_mesh_step, true})};
  }

 private:
  /// Measures `search`, which returns parameters and how many simulations it took to find them.
  template <class Search>
  Attempt timed(const Search& search) const {
    const double start = wall_seconds();
    const double cpu = cpu_seconds();
    const std::pair<Eigen::VectorXd, int> found = search();
    Attempt attempt{0, found.second, wall_seconds() - start, cpu_seconds() - cpu};
    attempt.deviation = deviation(found.first);
    return attempt;
  }

  Attempt network_alone() const {
    return timed([&] {
      design::DesignOptions options;
      options.multi_start = Switch::off;
      options.envelope = Switch::off;
      return std::pair{design::find_design(buildable_, {{target_}, start_, {}}, options).parameters, 0};
    });
  }

  Attempt network(bool polished) const {
    return timed([&] {
      const design::DesignProblem problem{{target_}, {}, {}};
      Eigen::VectorXd found = design::find_design(buildable_, problem).parameters;
      if (!polished) return std::pair{found, 0};
      design::PolishOptions options;
      options.tolerance = close_enough;
      options.max_rounds = native_.polish_rounds;
      options.max_seconds = 3600;  // rounds limit it, on whatever machine
      const auto result = design::polish(buildable_, problem, found, simulate_, options);
      return std::pair{result.parameters, static_cast<int>(result.rounds.size())};
    });
  }

  Attempt native(NativeResiduals::Differences differences) const {
    return timed([&] {
      const neural::Network& box = space_.model.network;
      NativeResiduals residuals(family_, sampled_, box, native_, differences);
      const auto found = numerics::minimize_least_squares(
          residuals, start_, box.lower, box.upper, {.tolerance = 1e-6, .target = close_enough, .max_iterations = 200});
      std::printf("  %s: |r| = %.5f, %s after %d steps, %d differences remeshed\n", family_.id.c_str(), found.norm,
                  to_string(found.stopped).data(), found.iterations, residuals.remeshed());
      return std::pair{found.x, residuals.simulations()};
    });
  }

  const LoadedSpace& space_;
  const tiling::Family& family_;
  const NativeSettings native_;
  const design::Target target_;
  const design::SampledTarget sampled_;
  const Eigen::VectorXd start_;
  const design::SimulateProfile simulate_;
  design::DesignSpace buildable_{space_.space()};
};

std::vector<Method> race(const LoadedSpace& space, const DesignSettings& settings) {
  const std::string& family = space.model.family;
  const NativeSettings native = native_settings(settings);
  const auto simulate = design::simulation_of(tiling::family(family), native.simulation);
  RandomStream random("native " + family, 1);
  auto methods = all_methods();
  const auto done = [&] { return static_cast<int>(methods.front().attempts.size()); };
  for (int i = 0; done() < native.targets && i < most_attempts * native.targets; ++i) {
    const auto target = simulated_target(space, design::Task::stress_strain, random, simulate);
    const auto start = random_parameters(space.model, random);
    if (!target) continue;
    try {
      Race one(space, settings, *target,
               Eigen::Map<const Eigen::VectorXd>(start.data(), static_cast<Eigen::Index>(start.size())));
      const double at_start =
          one.deviation(Eigen::Map<const Eigen::VectorXd>(start.data(), static_cast<Eigen::Index>(start.size())));
      if (!std::isfinite(at_start)) continue;
      const auto attempts = one.run();
      std::printf("%s: starts at %.2f %%;", family.c_str(), 100 * at_start);
      for (std::size_t m = 0; m < attempts.size(); ++m) {
        methods[m].attempts.push_back(attempts[m]);
        std::printf(" %.3f %% (%d, %.1f s)", 100 * attempts[m].deviation, attempts[m].simulations, attempts[m].seconds);
      }
      std::printf("\n");
      std::fflush(stdout);
    } catch (const Error& failure) {
      std::printf("%s: %s\n", family.c_str(), failure.what());
    }
  }
  return methods;
}

void write_page(const DesignSettings& settings, const Table& table) {
  Report report(settings.folder, "designs-native", "Inverse design: over the network or over simulations");
  report.table(table);
  report.write(design_introduction(
      settings, "native",
      "Targets are what hidden random designs do when they are simulated on the mesh that verifies designs: stress at "
      "10 strains from -0.1 to 0.2 along a random direction. A second random design is where searches start; both can "
      "be simulated at every sample. Each method's design is then simulated on that same mesh; deviations are relative "
      "root mean squares from the target.\n\n"
      "- *network, from the start*: `find_design` from the random start alone.\n"
      "- *network, with its own starts*: `find_design` as users get it, which chooses its starting points itself.\n"
      "- *network and polish*: then `polish`, until simulation deviates by at most 0.1 %, in at most 30 rounds.\n"
      "- *simulation*: from the random start, the solver of our outer problem, `numerics::minimize_least_squares`, asks"
      " simulations alone. Its Jacobian is by forward differences over a share of each parameter's range. It ends at "
      "0.1 % as well, where no step promises more, or after 60 simulations, and each design is meshed anew on the mesh "
      "that verifies. In the last row the simulations for differences alone have the design's mesh, its nodes moved "
      "with the outline, so that no triangle changes.\n\n"
      "The simulations that judge a result are not counted, nor are they in the times. The machine was not idle."));
}

}  // namespace

void study_native(const DesignSettings& given) {
  DesignSettings settings = given;
  if (settings.families.empty()) settings.families = {"IH01", "IH67"};
  if (settings.brief) settings.families.resize(1);
  Table table("designs-native", {{"family", "Family"},
                                 {"task", "Task"},
                                 {"method", "Method"},
                                 {"targets", "Targets"},
                                 {"deviation_median", "Deviation by simulation, median, %"},
                                 {"deviation_worst", "Worst, %"},
                                 {"within_1_percent", "Within 1 %"},
                                 {"within_0_1_percent", "Within 0.1 %"},
                                 {"simulations", "Simulations, median"},
                                 {"seconds", "Elapsed s, median"},
                                 {"cpu_seconds", "CPU s of all threads, median"}});
  for (const auto& space : spaces_of(settings)) {
    for (const Method& method : race(*space, settings)) {
      if (method.attempts.empty()) continue;
      const auto deviations = method.all(&Attempt::deviation);
      table.row({space->model.family, std::string(to_string(design::Task::stress_strain)), method.name,
                 count(static_cast<double>(method.attempts.size())), number(100 * median(deviations)),
                 number(100 * quantile(deviations, 1)), count(method.within(found_within)),
                 count(method.within(close_enough)), count(method.simulations()),
                 number(median(method.all(&Attempt::seconds))), number(median(method.all(&Attempt::cpu)))});
    }
    // What a long run has by now is kept if it is ended.
    write_page(given, table);
  }
}

}  // namespace supple::bench
