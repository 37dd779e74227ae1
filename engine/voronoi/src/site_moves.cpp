#include "site_moves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace supple::voronoi {
namespace {

/// Lengths of moves in mean cell sizes, in descending order.
constexpr std::array trial_lengths{0.3, 0.1, 0.03, 0.01, 1e-3};
constexpr int direction_count = 8;
/// Maximum number of repetitions of moves of one length in a pass, while they lower the energy.
constexpr int max_repeats = 3;
/// Minimum decrease of the energy by a move, as a fraction of the mean energy of a cell.
constexpr double min_site_gain = 1e-2;
/// A pass that has lowered the energy by this fraction ends early, because the minimizer then gains more for less work.
constexpr double sufficient_gain = 0.02;

}  // namespace

SiteMoves::SiteMoves(std::shared_ptr<const DiagramEvaluator> evaluator, std::vector<std::shared_ptr<DiagramTerm>> terms,
                     std::vector<bool> fixed, double unit)
    : evaluator_(std::move(evaluator)),
      terms_(std::move(terms)),
      fixed_(std::move(fixed)),
      unit_(unit),
      random_("moves of single sites", 1) {}

SiteMoves::EvaluatedSites SiteMoves::evaluate(SitesState state) {
  execution_.cancellation.throw_if_requested();
  evaluator_->evaluate(state, 0, execution_);
  EvaluatedSites result{std::move(state), {}, 0};
  result.energies.setZero(static_cast<Eigen::Index>(result.state.sites().points().size()));
  for (const auto& term : terms_) term->add_cell_energies(result.state, result.energies);
  result.energy = result.energies.sum();
  return result;
}

SiteMoves::EvaluatedSites SiteMoves::evaluate_move(const std::vector<std::int32_t>& sites, const Move& move) {
  SitesState state = current_->state;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(state.dimension());
  const Eigen::Vector2d own = move.length * Eigen::Vector2d(std::cos(move.angle), std::sin(move.angle));
  for (const std::int32_t site : sites) step.segment<2>(2 * static_cast<Eigen::Index>(site)) = own;
  state.move(step);
  return evaluate(std::move(state));
}

std::vector<std::vector<std::int32_t>> SiteMoves::independent_classes() const {
  const std::vector<DiagramCell>& cells = current_->state.evaluation()->diagram.cells;
  std::vector<std::vector<std::int32_t>> classes;
  std::vector<std::vector<bool>> changed;  // the cells whose energies a move of a class changes
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (fixed_[2 * i]) continue;
    const auto is_free = [&](const std::vector<bool>& changed_cells) {
      return !changed_cells[i] && std::ranges::none_of(cells[i].neighbours, [&](std::int32_t k) {
        return changed_cells[static_cast<std::size_t>(k)];
      });
    };
    const auto found = static_cast<std::size_t>(std::ranges::find_if(changed, is_free) - changed.begin());
    if (found == changed.size()) {
      changed.emplace_back(cells.size(), false);
      classes.emplace_back();
    }
    classes[found].push_back(static_cast<std::int32_t>(i));
    changed[found][i] = true;
    for (const std::int32_t k : cells[i].neighbours) changed[found][static_cast<std::size_t>(k)] = true;
  }
  return classes;
}

template <class Visit>
void SiteMoves::visit_changed(const EvaluatedSites& trial, std::int32_t site, const Visit& visit) const {
  const auto& before = current_->state.evaluation()->diagram.cells[static_cast<std::size_t>(site)].neighbours;
  const auto& after = trial.state.evaluation()->diagram.cells[static_cast<std::size_t>(site)].neighbours;
  visit(site);
  for (const std::int32_t cell : before)
    if (cell != site) visit(cell);
  for (const std::int32_t cell : after)
    if (cell != site && !std::ranges::binary_search(before, cell)) visit(cell);
}

void SiteMoves::accept(EvaluatedSites trial, const std::vector<std::int32_t>& sites, double length) {
  *current_ = std::move(trial);
  for (const std::int32_t site : sites) moved_lengths_[static_cast<std::size_t>(site)] += length;
  pass_.taken += static_cast<std::int64_t>(sites.size());
}

std::vector<std::int32_t> SiteMoves::try_move(const std::vector<std::int32_t>& sites, const Move& move) {
  EvaluatedSites trial = evaluate_move(sites, move);
  pass_.tried += static_cast<std::int64_t>(sites.size());
  if (sites.size() == 1) {
    if (!(trial.energy < current_->energy - min_gain_)) return {};
    accept(std::move(trial), sites, move.length);
    return sites;
  }
  std::vector<std::int32_t> moved_site(static_cast<std::size_t>(current_->energies.size()), -1);
  // Sites whose part of the change is not known, because their neighbourhoods overlap.
  std::vector<std::int32_t> ambiguous;
  for (const std::int32_t site : sites) {
    visit_changed(trial, site, [&](std::int32_t cell) {
      std::int32_t& other = moved_site[static_cast<std::size_t>(cell)];
      if (other >= 0) ambiguous.insert(ambiguous.end(), {other, site});
      other = site;
    });
  }
  std::vector<std::int32_t> accepted;
  for (const std::int32_t site : sites) {
    if (std::ranges::find(ambiguous, site) != ambiguous.end()) continue;
    double change = 0;
    visit_changed(trial, site, [&](std::int32_t cell) { change += trial.energies[cell] - current_->energies[cell]; });
    if (change < -min_gain_) accepted.push_back(site);
  }
  if (!accepted.empty()) {
    EvaluatedSites best = accepted.size() == sites.size() ? std::move(trial) : evaluate_move(accepted, move);
    if (best.energy < current_->energy - min_gain_) {
      accept(std::move(best), accepted, move.length);
    } else {
      ambiguous.insert(ambiguous.end(), accepted.begin(), accepted.end());
      accepted.clear();
    }
  }
  std::ranges::sort(ambiguous);
  ambiguous.erase(std::unique(ambiguous.begin(), ambiguous.end()), ambiguous.end());
  for (const std::int32_t site : ambiguous)
    if (!try_move({site}, move).empty()) accepted.push_back(site);
  return accepted;
}

SiteMovesPass SiteMoves::pass(SitesState& state, const Execution& execution) {
  execution_ = execution;
  execution_.progress = nullptr;
  current_ = std::make_unique<EvaluatedSites>(evaluate(state));
  const double start = current_->energy;
  pass_ = {};
  moved_lengths_.assign(state.sites().points().size(), 0);
  min_gain_ = min_site_gain * start / static_cast<double>(moved_lengths_.size());
  for (const double length : trial_lengths) {
    if (current_->energy < (1 - sufficient_gain) * start) {
      pass_.complete = false;
      break;
    }
    const double offset = random_.uniform();
    for (std::vector<std::int32_t> sites : independent_classes()) {
      for (int repeat = 0; repeat < max_repeats && !sites.empty(); ++repeat) {
        std::vector<std::int32_t> improved;
        for (int k = 0; k < direction_count; ++k) {
          const auto accepted =
              try_move(sites, {length * unit_, 2 * std::numbers::pi * (k + offset) / direction_count});
          improved.insert(improved.end(), accepted.begin(), accepted.end());
        }
        std::ranges::sort(improved);
        improved.erase(std::unique(improved.begin(), improved.end()), improved.end());
        sites = std::move(improved);
      }
    }
  }
  pass_.gain = start > 0 ? 1 - current_->energy / start : 0;
  pass_.step_length =
      Eigen::Map<const Eigen::VectorXd>(moved_lengths_.data(), static_cast<Eigen::Index>(moved_lengths_.size())).norm();
  if (pass_.taken > 0) {
    state = current_->state;
    state.set_evaluation(nullptr);
  }
  current_.reset();
  return pass_;
}

}  // namespace supple::voronoi
