// A design objective along a line in parameter space: simulations shake with their meshes, the network does not
// (thesis 4.4.3, fig. 4.12).
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "design_bench.h"
#include "measurement.h"
#include "report.h"
#include "simulation_bench.h"
#include "supple/base/error.h"
#include "supple/design/verification.h"
#include "supple/tiling/mesh.h"
#include "supple/tiling/structure.h"

namespace supple::bench {
namespace {

/// Where the line's middle and the target's design lie in the family's box, as shares of each parameter's range.
constexpr double middle_share = 0.5;
constexpr double target_share = 0.65;
/// Steps along the line, as shares of the ranges: of the thesis's figure, and longer ones over a wider range.
constexpr double millionth_step = 1e-6;
constexpr double thousandth_step = 1e-3;
/// Of the close-up: half its width, in beam widths.
constexpr double close_up_reach = 1.5;
/// Ends of sides that moved by less, in mesh sizes, count as the same when places for the close-up are chosen: where
/// triangles stay, a step of a thousandth moves nodes by up to 0.16.
constexpr double same_place = 0.2;

struct Side {
  Eigen::Vector2d middle;  ///< within the cell
  Eigen::Vector2d along;   ///< from one end to the other
};

std::vector<Side> sides_of(const tiling::PeriodicMesh& mesh) {
  const Eigen::Matrix2d inverse = mesh.lattice.inverse();
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  std::vector<bool> seen(static_cast<std::size_t>(mesh.nodes.cols()), false);
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    for (int k = 0; k < 3; ++k) {
      // The node in the middle of a side is its side's alone.
      const auto node =
          static_cast<std::size_t>(mesh.triangles[static_cast<std::size_t>(t)][3 + static_cast<std::size_t>(k)]);
      if (seen[node]) continue;
      seen[node] = true;
      const Eigen::Vector2d from = mesh.corner(t, k);
      const Eigen::Vector2d to = mesh.corner(t, (k + 1) % 3);
      Eigen::Vector2d share = inverse * (0.5 * (from + to));
      share -= share.array().floor().matrix();
      sides.push_back({mesh.lattice * share, to - from});
    }
  }
  return sides;
}

/// Sides of `after` whose ends are not where those of a side of `before` are.
std::vector<Side> changed_sides(const tiling::PeriodicMesh& before, const tiling::PeriodicMesh& after) {
  const double tolerance = same_place * before.mesh_size;
  const Eigen::Matrix2d inverse = before.lattice.inverse();
  const auto known = sides_of(before);
  // By rows of the cell in which a middle lies, and those beside it, so that rounding at their edges does not matter.
  const auto row_of = [&](const Side& side) { return std::lround(side.middle.x() / before.mesh_size); };
  std::multimap<long, std::size_t> rows;
  for (std::size_t i = 0; i < known.size(); ++i) rows.emplace(row_of(known[i]), i);
  const auto same = [&](const Side& a, const Side& b) {
    Eigen::Vector2d share = inverse * (a.middle - b.middle);
    share -= share.array().round().matrix();
    return (before.lattice * share).norm() < tolerance &&
           std::min((a.along - b.along).norm(), (a.along + b.along).norm()) < tolerance;
  };
  std::vector<Side> changed;
  for (const Side& side : sides_of(after)) {
    bool found = false;
    for (long row = row_of(side) - 1; row <= row_of(side) + 1 && !found; ++row) {
      const auto [first, last] = rows.equal_range(row);
      found = std::any_of(first, last, [&](const auto& entry) { return same(side, known[entry.second]); });
    }
    // At the cell's edge the same side may be listed on the other edge.
    if (!found) found = std::any_of(known.begin(), known.end(), [&](const Side& other) { return same(side, other); });
    if (!found) changed.push_back(side);
  }
  return changed;
}

/// The changed side that has most others within the window around it.
Eigen::Vector2d busiest_place(const std::vector<Side>& changed, double half_width) {
  Eigen::Vector2d best = Eigen::Vector2d::Zero();
  std::ptrdiff_t most = -1;
  for (const Side& side : changed) {
    const auto near = std::count_if(changed.begin(), changed.end(), [&](const Side& other) {
      return (other.middle - side.middle).cwiseAbs().maxCoeff() < half_width;
    });
    if (near > most) {
      most = near;
      best = side.middle;
    }
  }
  return best;
}

/// The sides of a mesh within the window around `centre`, in beam widths from there.
void add_close_up(Table& table, const std::string& family, double step, int index, const tiling::PeriodicMesh& mesh,
                  const Eigen::Vector2d& centre) {
  const double reach = close_up_reach * mesh.beam_width + 2 * mesh.mesh_size;
  for (const Side& side : sides_of(mesh)) {
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        const Eigen::Vector2d middle = side.middle + mesh.lattice * Eigen::Vector2d(i, j) - centre;
        if (middle.cwiseAbs().maxCoeff() > reach) continue;
        const Eigen::Vector2d from = (middle - 0.5 * side.along) / mesh.beam_width;
        const Eigen::Vector2d to = (middle + 0.5 * side.along) / mesh.beam_width;
        table.row({family, number(step), std::to_string(index), number(from.x(), 7), number(from.y(), 7),
                   number(to.x(), 7), number(to.y(), 7)});
      }
    }
  }
}

/// A family, the line through its box and the objective.
class Line {
 public:
  Line(const LoadedSpace& space, const DesignSettings& settings)
      : space_(space), family_(tiling::family(space.model.family)) {
    data_set_.mesh = data_set_options(space.model.family).mesh;
    verification_ = design::verification_options();
    if (settings.brief) data_set_.mesh.mesh_size = verification_.mesh.mesh_size = 1;
    data_set_.tolerance = verification_.tolerance = 1e-9;  // what shakes the curve is the mesh
    design::Target target;
    target.interpolation = numerics::Interpolation::linear;
    target.samples = samples;
    for (int i = 0; i < samples; ++i) target.control_points.emplace_back(-0.04 + 0.035 * i, 0);
    const auto aim = simulated(target_share, design::sample_target(target).samples, verification_);
    for (int i = 0; i < samples; ++i) target.control_points[static_cast<std::size_t>(i)][1] = aim[i];
    target_ = design::sample_target(target);
  }

  std::vector<double> parameters(double share) const {
    std::vector<double> x;
    x.reserve(family_.parameters.size());
    for (const auto& p : family_.parameters) x.push_back(p.lower + share * (p.upper - p.lower));
    return x;
  }
  double by_network(double share) const {
    const auto profile = design::evaluate_profile(space_.model, space_.evaluator, parameters(share), target_.samples);
    return objective(profile.y);
  }
  double by_simulation(double share, bool verified) const {
    return objective(simulated(share, target_.samples, verified ? verification_ : data_set_));
  }
  tiling::PeriodicMesh mesh(double share, bool verified) const {
    return tiling::mesh_structure(tiling::make_structure(family_, parameters(share)),
                                  (verified ? verification_ : data_set_).mesh);
  }
  const std::string& family() const { return family_.id; }

 private:
  static constexpr int samples = 5;  ///< strains of -0.04 to 0.1, none of them 0

  Eigen::VectorXd simulated(double share, const design::ProfileSamples& at,
                            const microscale::SimulationOptions& options) const {
    return design::simulate_profile(tiling::make_structure(family_, parameters(share)), at, options);
  }
  double objective(const Eigen::VectorXd& y) const {
    const auto deviation = target_.relative_rms(y);
    if (!deviation) throw Error("design.no_equilibrium", family_.id + " does not reach every strain along the line");
    return *deviation;
  }

  const LoadedSpace& space_;
  const tiling::Family& family_;
  microscale::SimulationOptions data_set_;
  microscale::SimulationOptions verification_;
  design::SampledTarget target_;
};

class SmoothnessStudy {
 public:
  explicit SmoothnessStudy(const DesignSettings& settings) : settings_(settings) {}

  void run() {
    DesignSettings settings = settings_;
    if (settings.families.empty()) settings.families = {"IH67"};
    for (const auto& space : spaces_of(settings)) {
      const Line line(*space, settings_);
      curves_along(line, millionth_step);
      curves_along(line, thousandth_step);
    }
    write();
  }

 private:
  void curves_along(const Line& line, double step) {
    const int n = settings_.brief ? 2 : 60;
    const int half = n / 2;
    const auto share = [&](int i) { return middle_share + step * (i - half); };
    std::vector<double> network;
    network.reserve(static_cast<std::size_t>(n) + 1);
    for (int i = 0; i <= n; ++i) network.push_back(line.by_network(share(i)));
    std::map<bool, std::vector<double>> simulated;
    for (const bool verified : {false, true}) {
      auto& values = simulated[verified];
      values.reserve(static_cast<std::size_t>(n) + 1);
      for (int i = 0; i <= n; ++i) values.push_back(line.by_simulation(share(i), verified));
      add(line.family(), step, verified ? "simulation, verification's mesh" : "simulation, data set's mesh", values,
          std::to_string(mesh_changes(line, step, n, verified)));
    }
    add(line.family(), step, "network", network, "");
    for (int i = 0; i <= n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      curves_.row({line.family(), number(step), std::to_string(i - half), number(simulated[false][at], 12),
                   number(simulated[true][at], 12), number(network[at], 12)});
    }
  }

  /// How many steps change which nodes make triangles; the liveliest two of the first kind of steps that do are drawn.
  int mesh_changes(const Line& line, double step, int n, bool verified) {
    const int half = n / 2;
    const auto share = [&](int i) { return middle_share + step * (i - half); };
    std::vector<tiling::PeriodicMesh> meshes;
    meshes.reserve(static_cast<std::size_t>(n) + 1);
    for (int i = 0; i <= n; ++i) meshes.push_back(line.mesh(share(i), verified));
    std::vector<std::vector<Side>> changed(static_cast<std::size_t>(n));
    int changes = 0;
    for (std::size_t i = 1; i < meshes.size(); ++i) {
      if (meshes[i].triangles == meshes[i - 1].triangles) continue;
      ++changes;
      changed[i - 1] = changed_sides(meshes[i - 1], meshes[i]);
    }
    if (!verified && drawn_ != line.family()) close_up(line, step, meshes, changed);
    return changes;
  }

  void close_up(const Line& line, double step, const std::vector<tiling::PeriodicMesh>& meshes,
                const std::vector<std::vector<Side>>& changed) {
    std::size_t middle = 1;
    std::size_t most = 0;
    for (std::size_t i = 1; i + 1 < meshes.size(); ++i) {
      // Two small changes show more than a large one, whose third mesh hides behind the second.
      const std::size_t both = std::min(changed[i - 1].size(), changed[i].size());
      const std::size_t size = both > 0 ? 1'000'000 + both : changed[i - 1].size() + changed[i].size();
      if (size > most) {
        most = size;
        middle = i;
      }
    }
    if (most == 0) return;
    drawn_ = line.family();
    std::vector<Side> around = changed[middle - 1];
    around.insert(around.end(), changed[middle].begin(), changed[middle].end());
    const Eigen::Vector2d centre = busiest_place(around, close_up_reach * meshes[middle].beam_width);
    text_ +=
        line.family() + ": " +
        (step == millionth_step ? "steps of a millionth"
                                : "no step of a millionth changes triangles visibly, so these are of a thousandth") +
        "; of " + count(static_cast<double>(sides_of(meshes[middle]).size())) + " sides of triangles, " +
        count(static_cast<double>(changed[middle - 1].size())) + " and " +
        count(static_cast<double>(changed[middle].size())) + " are new after the two steps that are drawn. ";
    for (std::size_t k = 0; k < 3; ++k) {
      const auto index = static_cast<int>(middle + k) - 1 - static_cast<int>(meshes.size() / 2);
      add_close_up(sides_, line.family(), step, index, meshes[middle + k - 1], centre);
    }
  }

  void add(const std::string& family, double step, const std::string& source, const std::vector<double>& values,
           const std::string& changes) {
    const Shaking shaking = shaking_of(values);
    table_.row({family, number(step), source, number(median(values), 4), number(shaking.typical),
                number(shaking.second), number(shaking.second_largest), std::to_string(shaking.against), changes,
                std::to_string(values.size() - 1)});
  }

  void write() {
    Report report(settings_.folder, "designs-smoothness", "Inverse design: the objective along a line");
    report.table(table_);
    report.image("designs-smoothness.svg", "The objective along the line, and three meshes laid over each other");
    report.text("The meshes are the data set's at three consecutive steps. " + text_ +
                "All values: [curves](designs-smoothness-curves.csv), [sides](designs-smoothness-sides.csv).");
    report.data(curves_);
    report.data(sides_);
    report.write(design_introduction(
        settings_, "smoothness",
        "The objective is the relative root mean square deviation of stress along x from a target, at five strains "
        "from -0.04 to 0.1. The target is what the design at 65 % of each parameter's range does on the verification's "
        "mesh. The line goes through the middle of the box, all parameters by the same share of their ranges, in steps "
        "of a millionth and of a thousandth. Each simulated design is meshed anew, tolerance 1e-9. Changes and second "
        "differences are over the curve's median value. A step changes the mesh where other nodes make triangles after "
        "it, or more or fewer of them."));
  }

  const DesignSettings& settings_;
  Table table_{"designs-smoothness",
               {{"family", "Family"},
                {"step", "Step"},
                {"source", "Source"},
                {"objective", "Objective, median"},
                {"typical", "Typical change over a step"},
                {"second", "Typical second difference"},
                {"second_largest", "Largest second difference"},
                {"against", "Steps against the trend"},
                {"mesh_changes", "Steps that change the mesh"},
                {"steps", "Of"}}};
  Table curves_{"designs-smoothness-curves",
                {{"family", "Family"},
                 {"step", "Step"},
                 {"index", "Steps from the middle"},
                 {"data_set", "Objective by simulation, data set's mesh"},
                 {"verification", "By simulation, verification's mesh"},
                 {"network", "By the network"}}};
  Table sides_{"designs-smoothness-sides",
               {{"family", "Family"},
                {"step", "Step"},
                {"index", "Steps from the middle"},
                {"x1", "x1"},
                {"y1", "y1"},
                {"x2", "x2"},
                {"y2", "y2"}}};
  std::string drawn_;  ///< the latest family that has a close-up
  std::string text_;
};

}  // namespace

void study_design_smoothness(const DesignSettings& settings) { SmoothnessStudy(settings).run(); }

}  // namespace supple::bench
