#include "site_moves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace supple::voronoi {
namespace {

/// Lengths of moves in mean cell sizes, the longest first.
constexpr std::array trial_lengths{0.3, 0.1, 0.03, 0.01, 1e-3};
constexpr int directions = 8;
/// Moves of one length are repeated while they gain, so often in one pass.
constexpr int max_repeats = 3;
/// A move has to lower the energy by this fraction of a site's mean share.
constexpr double smallest_gain_of_a_site = 1e-2;
/// A pass that has lowered the energy by this fraction is not completed: the minimizer gains more by less work.
constexpr double large_gain = 0.02;

}  // namespace

SiteMoves::SiteMoves(std::shared_ptr<const DiagramFinder> finder, std::vector<std::shared_ptr<DiagramTerm>> terms,
                     std::vector<bool> held, double unit)
    : finder_(std::move(finder)),
      terms_(std::move(terms)),
      held_(std::move(held)),
      unit_(unit),
      random_("moves of single sites", 1) {}

SiteMoves::Place SiteMoves::evaluated(SitesState state) {
  execution_.cancellation.throw_if_requested();
  finder_->find(state, 0, execution_);
  Place place{std::move(state), {}, 0};
  place.energies.setZero(static_cast<Eigen::Index>(place.state.sites().points().size()));
  for (const auto& term : terms_) term->add_cell_energies(place.state, place.energies);
  place.energy = place.energies.sum();
  return place;
}

SiteMoves::Place SiteMoves::moved(const std::vector<std::int32_t>& sites, const Move& move) {
  SitesState state = here_->state;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(state.dimension());
  const Eigen::Vector2d own = move.length * Eigen::Vector2d(std::cos(move.angle), std::sin(move.angle));
  for (const std::int32_t site : sites) step.segment<2>(2 * static_cast<Eigen::Index>(site)) = own;
  state.move(step);
  return evaluated(std::move(state));
}

std::vector<std::vector<std::int32_t>> SiteMoves::independent_classes() const {
  const std::vector<DiagramCell>& cells = here_->state.found()->diagram.cells;
  std::vector<std::vector<std::int32_t>> classes;
  std::vector<std::vector<bool>> changed;  // the cells that a move of a class changes
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (held_[2 * i]) continue;
    const auto is_free = [&](const std::vector<bool>& taken) {
      return !taken[i] && std::ranges::none_of(cells[i].neighbours,
                                               [&](std::int32_t k) { return taken[static_cast<std::size_t>(k)]; });
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
void SiteMoves::visit_changed(const Place& beside, std::int32_t site, const Visit& visit) const {
  const auto& before = here_->state.found()->diagram.cells[static_cast<std::size_t>(site)].neighbours;
  const auto& after = beside.state.found()->diagram.cells[static_cast<std::size_t>(site)].neighbours;
  visit(site);
  for (const std::int32_t cell : before)
    if (cell != site) visit(cell);
  for (const std::int32_t cell : after)
    if (cell != site && !std::ranges::binary_search(before, cell)) visit(cell);
}

void SiteMoves::take(Place place, const std::vector<std::int32_t>& sites, double length) {
  *here_ = std::move(place);
  for (const std::int32_t site : sites) ways_[static_cast<std::size_t>(site)] += length;
  pass_.taken += static_cast<std::int64_t>(sites.size());
}

std::vector<std::int32_t> SiteMoves::try_move(const std::vector<std::int32_t>& sites, const Move& move) {
  Place beside = moved(sites, move);
  pass_.tried += static_cast<std::int64_t>(sites.size());
  if (sites.size() == 1) {
    if (!(beside.energy < here_->energy - least_gain_)) return {};
    take(std::move(beside), sites, move.length);
    return sites;
  }
  std::vector<std::int32_t> mover(static_cast<std::size_t>(here_->energies.size()), -1);
  std::vector<std::int32_t> unclear;  // sites whose share of the change is not known
  for (const std::int32_t site : sites) {
    visit_changed(beside, site, [&](std::int32_t cell) {
      std::int32_t& other = mover[static_cast<std::size_t>(cell)];
      if (other >= 0) unclear.insert(unclear.end(), {other, site});
      other = site;
    });
  }
  std::vector<std::int32_t> better;
  for (const std::int32_t site : sites) {
    if (std::ranges::find(unclear, site) != unclear.end()) continue;
    double change = 0;
    visit_changed(beside, site, [&](std::int32_t cell) { change += beside.energies[cell] - here_->energies[cell]; });
    if (change < -least_gain_) better.push_back(site);
  }
  if (!better.empty()) {
    Place best = better.size() == sites.size() ? std::move(beside) : moved(better, move);
    if (best.energy < here_->energy - least_gain_) {
      take(std::move(best), better, move.length);
    } else {
      unclear.insert(unclear.end(), better.begin(), better.end());
      better.clear();
    }
  }
  std::ranges::sort(unclear);
  unclear.erase(std::unique(unclear.begin(), unclear.end()), unclear.end());
  for (const std::int32_t site : unclear)
    if (!try_move({site}, move).empty()) better.push_back(site);
  return better;
}

SiteMovesPass SiteMoves::pass(SitesState& state, const Execution& execution) {
  execution_ = execution;
  execution_.progress = nullptr;
  here_ = std::make_unique<Place>(evaluated(state));
  const double start = here_->energy;
  pass_ = {};
  ways_.assign(state.sites().points().size(), 0);
  least_gain_ = smallest_gain_of_a_site * start / static_cast<double>(ways_.size());
  for (const double length : trial_lengths) {
    if (here_->energy < (1 - large_gain) * start) {
      pass_.complete = false;
      break;
    }
    const double turn = random_.uniform();
    for (std::vector<std::int32_t> sites : independent_classes()) {
      for (int repeat = 0; repeat < max_repeats && !sites.empty(); ++repeat) {
        std::vector<std::int32_t> gained;
        for (int k = 0; k < directions; ++k) {
          const auto better = try_move(sites, {length * unit_, 2 * std::numbers::pi * (k + turn) / directions});
          gained.insert(gained.end(), better.begin(), better.end());
        }
        std::ranges::sort(gained);
        gained.erase(std::unique(gained.begin(), gained.end()), gained.end());
        sites = std::move(gained);
      }
    }
  }
  pass_.gain = start > 0 ? 1 - here_->energy / start : 0;
  pass_.step_length = Eigen::Map<const Eigen::VectorXd>(ways_.data(), static_cast<Eigen::Index>(ways_.size())).norm();
  if (pass_.taken > 0) {
    state = here_->state;
    state.set_found(nullptr);
  }
  here_.reset();
  return pass_;
}

}  // namespace supple::voronoi
