#include "supple/microscale/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "cell_model.h"
#include "cell_path.h"
#include "fine_equilibria.h"
#include "homogenization.h"
#include "load_targets.h"
#include "patch_stability.h"
#include "supple/base/faults.h"
#include "supple/microscale/simulation_error.h"

namespace supple::microscale {
namespace {

/// Throws "simulation.invalid_option" for every option out of range.
void check(const SimulationOptions& options) {
  Faults faults;
  const Material& material = options.material;
  faults.require(material.youngs_modulus > 0 && std::isfinite(material.youngs_modulus), "material/youngs_modulus",
                 "must be positive and finite, in MPa");
  faults.require(material.law != Law::neo_hookean || (material.poisson_ratio > -1 && material.poisson_ratio < 0.4999),
                 "material/poisson_ratio", "must lie within (-1, 0.4999); use incompressible_plane_stress for 0.5");
  faults.require(options.tolerance >= 1e-12 && options.tolerance <= 1e-2, "tolerance", "must lie within [1e-12, 1e-2]");
  faults.require(options.max_iterations >= 1 && options.max_iterations <= 10'000, "max_iterations",
                 "must lie within [1, 10000]");
  faults.require(options.max_load_step >= 1e-5 && options.max_load_step <= 10, "max_load_step",
                 "must lie within [1e-5, 10]");
  faults.throw_if_any<SimulationError>("simulation.invalid_option");
}

}  // namespace

std::string_view to_string(Law law) { return law == Law::neo_hookean ? "neo_hookean" : "incompressible_plane_stress"; }

std::string_view to_string(Stop stop) {
  switch (stop) {
    case Stop::converged:
      return "converged";
    case Stop::iteration_limit:
      return "iteration_limit";
    case Stop::step_too_small:
      break;
  }
  return "step_too_small";
}

namespace {

/// The models of a simulator, which all its loads use.
struct Models {
  SimulationOptions options;
  CellModel cell;
  std::unique_ptr<CellModel> patch;  ///< 2x2 cells; made when they are first needed
  /// Equilibria on the finer meshes of one cell and of the patch; made when they are first needed.
  std::unique_ptr<FineEquilibria> fine_cell, fine_patch;
  PatchStability patch_stability;

  Models(tiling::PeriodicMesh mesh, const SimulationOptions& requested)
      : options(requested),
        cell(std::move(mesh), requested.material, requested.contact != Switch::off),
        patch_stability(cell.coordinates().strain()) {}

  CellModel& two_by_two() {
    if (!patch)
      patch = std::make_unique<CellModel>(tiling::repeat(*cell.mesh(), 2, 2), options.material,
                                          options.contact != Switch::off);
    return *patch;
  }

  FineEquilibria& fine_equilibria(const CellModel& model) {
    std::unique_ptr<FineEquilibria>& equilibria = &model == &cell ? fine_cell : fine_patch;
    if (!equilibria) equilibria = std::make_unique<FineEquilibria>(model, options);
    return *equilibria;
  }
};

/// Follows one load path of a simulator.
class Run {
 public:
  Run(Models& models, const Load& load, const Execution& execution)
      : models_(models), options_(models.options), targets_(targets_of(load)), execution_(execution) {}

  SimulationResult run() {
    result_.nodes = static_cast<int>(models_.cell.mesh()->nodes.cols());
    result_.extrapolated = refinement() == Refinement::extrapolated;
    model_ = options_.patch == Switch::on ? &models_.two_by_two() : &models_.cell;
    model_->reset_contact();
    path_ = make_path(Eigen::VectorXd::Zero(model_->coordinates().size()));
    path_->find_equilibrium();
    const int n = static_cast<int>(targets_.gradients.size());
    for (int i = 0; i < n; ++i) {
      execution_.checkpoint(static_cast<double>(i) / n, "states");
      if (!follow_to(targets_.gradients[static_cast<std::size_t>(i)])) {
        record_state();
        result_.message = "State " + std::to_string(i) +
                          " could not be reached: the load step was halved down to its " +
                          "limit without convergence (" + std::string(to_string(result_.states.back().stopped)) + ").";
        break;
      }
      record_state();
    }
    bill_effects();
    return std::move(result_);
  }

 private:
  std::unique_ptr<CellPath> make_path(Eigen::VectorXd x) {
    auto path = std::make_unique<CellPath>(*model_, std::move(x), targets_.free, options_, execution_);
    result_.unknowns = std::max(result_.unknowns, static_cast<int>(path->unknowns()));
    return path;
  }

  /// Follows the path to the prescribed components of `target`. Returns false if it ends before.
  bool follow_to(const Eigen::Matrix2d& target) {
    while (true) {
      const auto progress = path_->step_towards(target);
      if (progress == CellPath::Progress::failed) return false;
      if (!continue_in_patch_if_unstable()) return false;
      if (progress == CellPath::Progress::complete) return true;
    }
  }

  /// If one cell's equilibrium is unstable in the 2x2 patch, continues the path with the patch. Returns false if no
  /// equilibrium of the patch is found.
  bool continue_in_patch_if_unstable() {
    alternating_stable_ = true;
    if (options_.patch != Switch::automatic || model_ != &models_.cell) return true;
    const auto instability = models_.patch_stability.find(*model_, path_->x(), execution_);
    if (!instability) return true;
    alternating_stable_ = false;
    if (options_.buckling == Switch::off) return true;
    const auto counts = path_->take_counts();
    iterations_ += counts.iterations;
    load_steps_ += counts.load_steps;
    branch_ += counts.branches_left;
    Eigen::VectorXd x = repeat_over_patch(path_->x());
    model_ = &models_.two_by_two();
    model_->reset_contact();
    path_ = make_path(std::move(x));
    if (!path_->leave_along(repeat_over_patch(*instability)) && !path_->find_equilibrium()) return false;
    alternating_stable_ = true;
    return true;
  }

  /// Appends the equilibrium with a reduced range of contact to the result. The path itself goes on with the full one.
  void record_state() {
    path_->reduce_contact_range();
    append_state();
    path_->restore_contact_range();
  }

  void append_state() {
    const Eigen::VectorXd& x = path_->x();
    const double area = model_->mesh()->cell_area();
    const CellEquilibrium& at = path_->equilibrium();
    const auto counts = path_->take_counts();
    branch_ += counts.branches_left;
    State state;
    PatchResponse response{model_->coordinates().deformation_gradient(x), at.strain_gradient, at.condensed, at.energy};
    if (refinement() != Refinement::off) state.mesh_error = refine(response, area);
    state.deformation_gradient = response.deformation_gradient;
    state.green_strain = green_strain(state.deformation_gradient);
    state.stress = second_piola_kirchhoff(state.deformation_gradient, response.strain_gradient, area);
    state.energy_density = response.energy / area;
    if (options_.tangents)
      state.tangent = tangent_stiffness(state.deformation_gradient, state.stress, response.condensed, area);
    state.stopped = path_->stopped();
    state.residual = at.residual;
    state.iterations = std::exchange(iterations_, 0) + counts.iterations;
    state.load_steps = std::exchange(load_steps_, 0) + counts.load_steps;
    if (const ContactBarrier* contact = model_->contact()) {
      const ContactStatus status = contact->status(x);
      state.contacts = status.pairs;
      state.smallest_gap = status.smallest_gap;
    }
    state.stable = path_->stable() && alternating_stable_;
    state.branch = branch_;
    state.cells = model_ == &models_.cell ? 1 : 2;
    state.smallest_jacobian = model_->elastic().smallest_jacobian(x);
    if (options_.deformed_meshes) state.deformed = deformed(x);
    result_.states.push_back(std::move(state));
  }

  /// The refinement that is requested, or off if the finer mesh would have too many nodes. Dividing triangles in four
  /// gives about four times as many nodes.
  Refinement refinement() const {
    const bool within_limit = 4 * static_cast<std::int64_t>(result_.nodes) <= options_.mesh.max_nodes;
    return within_limit ? options_.refinement : Refinement::off;
  }

  /// Finds the state on the finer mesh too, and extrapolates `response` if that is requested. Returns the estimated
  /// error of `response`.
  std::optional<MeshError> refine(PatchResponse& response, double area) {
    if (path_->stopped() != Stop::converged || !path_->stable() || !alternating_stable_) return std::nullopt;
    CostLedger cost;
    std::optional<FineEquilibria::FineEquilibrium> found;
    {
      const StageTimer timer(&cost, "refinement");
      found = models_.fine_equilibria(*model_).find(*path_, targets_.free, {execution_.cancellation, nullptr, nullptr});
    }
    ++refinements_;
    refinement_seconds_ += cost.total_seconds();
    if (!found) return std::nullopt;
    const PatchResponse coarse = response;
    // If one mesh has buckled and the other has not, their difference does not decrease with the mesh size as it does
    // elsewhere. Nothing is extrapolated then.
    if (!found->same_branch || refinement() == Refinement::estimated)
      return coarse_error(coarse, found->response, area);
    response = extrapolate(coarse, found->response);
    return extrapolation_error(coarse, found->response, area);
  }

  DeformedMesh deformed(const Eigen::VectorXd& x) const {
    const tiling::PeriodicMesh& mesh = *model_->mesh();
    const Eigen::Matrix2d f = model_->coordinates().deformation_gradient(x);
    DeformedMesh result{model_->mesh(), f * mesh.lattice, f * mesh.nodes};
    result.nodes += Eigen::Map<const Eigen::Matrix2Xd>(x.data(), 2, mesh.nodes.cols());
    return result;
  }

  std::string_view refinement_reason() const {
    if (options_.refinement == Refinement::off) return "switched off by the request";
    if (refinement() == Refinement::off) return "the finer mesh would have more nodes than the limit";
    if (refinements_ == 0) return "no state converged to a stable equilibrium";
    return options_.refinement == Refinement::estimated ? "the error of the mesh that was asked for is estimated"
                                                        : "the error of the mesh is extrapolated away and estimated";
  }

  /// Whether the bill already has the effect, because a term was evaluated or a branch was left.
  bool has_run(std::string_view effect) const {
    const auto& effects = execution_.cost->effects();
    return std::any_of(effects.begin(), effects.end(),
                       [effect](const CostLedger::Effect& e) { return e.name == effect && e.ran; });
  }

  /// Bills the effects that neither a term nor the path has billed, with the reason why they ran or did not run.
  void bill_effects() const {
    if (!execution_.cost) return;
    if (options_.contact == Switch::off) {
      execution_.cost->add_effect("contact", false, "switched off by the request");
    } else if (!has_run("contact")) {
      execution_.cost->add_effect("contact", false, "no pair of boundary points came within the barrier's range");
    }
    const bool uses_patch = model_ != &models_.cell;
    execution_.cost->add_effect("patch", uses_patch,
                                options_.patch == Switch::on    ? "switched on by the request"
                                : options_.patch == Switch::off ? "switched off by the request"
                                : uses_patch ? "one cell was unstable against a mode that alternates from cell to cell"
                                             : "one cell was stable against all modes of the 2x2 patch");
    execution_.cost->add_effect("refinement", refinements_ > 0, refinement_reason(), refinements_, refinement_seconds_);
    if (!has_run("buckling"))
      execution_.cost->add_effect("buckling", false,
                                  options_.buckling == Switch::off ? "switched off by the request"
                                                                   : "the tangent stiffness stayed positive definite");
  }

  Models& models_;
  const SimulationOptions& options_;
  LoadTargets targets_;
  const Execution& execution_;
  CellModel* model_ = nullptr;
  std::unique_ptr<CellPath> path_;
  SimulationResult result_;
  bool alternating_stable_ = true;
  int branch_ = 0;
  int iterations_ = 0;
  int load_steps_ = 0;
  int refinements_ = 0;
  double refinement_seconds_ = 0;
};

}  // namespace

struct Simulator::Implementation : Models {
  using Models::Models;
};

Simulator::Simulator(const tiling::Structure& structure, const SimulationOptions& options, const Execution& execution) {
  check(options);
  const StageTimer timer(execution.cost, "meshing");
  implementation_ =
      std::make_unique<Implementation>(tiling::mesh_structure(structure, options.mesh, execution), options);
}

Simulator::Simulator(tiling::PeriodicMesh one_cell, const SimulationOptions& options, const Execution&) {
  check(options);
  implementation_ = std::make_unique<Implementation>(std::move(one_cell), options);
}

Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

SimulationResult Simulator::run(const Load& load, const Execution& execution) {
  return Run(*implementation_, load, execution).run();
}

const tiling::PeriodicMesh& Simulator::mesh() const { return *implementation_->cell.mesh(); }

SimulationResult simulate(const tiling::Structure& structure, const Load& load, const SimulationOptions& options,
                          const Execution& execution) {
  return Simulator(structure, options, execution).run(load, execution);
}

}  // namespace supple::microscale
