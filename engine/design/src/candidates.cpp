#include "supple/design/candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <list>
#include <mutex>
#include <utility>

#include "sampled_profile.h"
#include "supple/base/sobol.h"

namespace supple::design {
namespace {

constexpr int candidates_per_parameter = 40;
/// Maximum number of cached tables of one model.
constexpr std::size_t max_cached_tables = 32;
/// Accuracy that suffices to compare candidates, and that single precision reaches at every strain.
constexpr neural::UniaxialOptions rough_options{.tolerance = 1e-2, .max_iterations = 12, .max_halvings = 6};

/// Candidate `index` of `count`. The corners of the box come first, because extreme responses are there, and then
/// points of a Sobol sequence. Corners are left out if they would be more than half of all candidates.
Eigen::VectorXd candidate(const SobolSequence& sequence, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                          int index, int count) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < lower.size(); ++k)
    if (lower[k] < upper[k]) free.push_back(k);
  const int all_corners = 1 << free.size();
  const int corners = 2 * all_corners <= count ? all_corners : 0;
  const auto point = sequence.point(static_cast<std::uint32_t>(std::max(0, index - corners)));
  Eigen::VectorXd parameters = lower;
  for (std::size_t k = 0; k < free.size(); ++k) {
    // Upper corners are exactly at the bounds, because they are assigned and not computed by a sum.
    if (index >= corners) {
      parameters[free[k]] += point[k] * (upper[free[k]] - lower[free[k]]);
    } else if (index >> k & 1) {
      parameters[free[k]] = upper[free[k]];
    }
  }
  return parameters;
}

using Key = std::vector<double>;

Key key_of(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, int count,
           const std::vector<ProfileSamples>& profiles) {
  Key key(lower.begin(), lower.end());
  key.insert(key.end(), upper.begin(), upper.end());
  key.push_back(count);
  for (const auto& profile : profiles) {
    key.insert(key.end(), {static_cast<double>(profile.task), static_cast<double>(profile.measure), profile.direction,
                           profile.orientation, profile.strain, static_cast<double>(profile.x.size())});
    key.insert(key.end(), profile.x.begin(), profile.x.end());
  }
  return key;
}

}  // namespace

int default_candidates(int free_parameters) { return candidates_per_parameter * std::max(1, free_parameters); }

struct Candidates::Content {
  explicit Content(const neural::Network& network) : evaluator(network) {}

  std::shared_ptr<const Table> find(const Key& key) {
    const std::lock_guard lock(mutex);
    const auto found =
        std::find_if(tables.begin(), tables.end(), [&](const auto& entry) { return entry.first == key; });
    if (found == tables.end()) return nullptr;
    tables.splice(tables.begin(), tables, found);
    return found->second;
  }
  void add(Key key, std::shared_ptr<const Table> table) {
    const std::lock_guard lock(mutex);
    tables.emplace_front(std::move(key), std::move(table));
    if (tables.size() > max_cached_tables) tables.pop_back();
  }

  neural::SingleEvaluator evaluator;
  std::mutex mutex;
  std::list<std::pair<Key, std::shared_ptr<const Table>>> tables;  ///< the most recently used first
};

Candidates::Candidates(const neural::Network& network) : content_(std::make_unique<Content>(network)) {}
Candidates::~Candidates() = default;
Candidates::Candidates(Candidates&&) noexcept = default;
Candidates& Candidates::operator=(Candidates&&) noexcept = default;

std::shared_ptr<const Candidates::Table> Candidates::table(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                                           int count, const std::vector<ProfileSamples>& profiles,
                                                           const Buildable& buildable,
                                                           const Execution& execution) const {
  auto key = key_of(lower, upper, count, profiles);
  if (auto cached = content_->find(key)) return cached;
  const StageTimer timer(execution.cost, "candidates");
  std::vector<Sample> samples;
  for (const auto& profile : profiles) {
    const auto more = samples_of(profile);
    samples.insert(samples.end(), more.begin(), more.end());
  }
  auto table = std::make_shared<Table>();
  table->parameters.resize(lower.size(), count);
  table->y.setConstant(static_cast<Eigen::Index>(samples.size()), count, std::numeric_limits<double>::quiet_NaN());
  const SobolSequence sequence("candidates", 1);
  Equilibria<float> equilibria(content_->evaluator, loadings_of(samples), rough_options);
  for (int c = 0; c < count; ++c) {
    execution.cancellation.throw_if_requested();
    table->parameters.col(c) = candidate(sequence, lower, upper, c, count);
    const Eigen::VectorXd parameters = table->parameters.col(c);
    if (buildable && !buildable(parameters)) continue;
    equilibria.from_rest(content_->evaluator.design({parameters.data(), static_cast<std::size_t>(parameters.size())}));
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!equilibria[i].converged) continue;
      table->y(static_cast<Eigen::Index>(i), c) = value_of(samples[i], equilibria.frame(i), equilibria[i]);
    }
  }
  if (execution.cost) execution.cost->add_quantity("evaluations", static_cast<double>(equilibria.evaluations()));
  content_->add(std::move(key), table);
  return table;
}

}  // namespace supple::design
