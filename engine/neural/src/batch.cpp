#include "supple/neural/batch.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>

#include "supple/base/error.h"
#include "supple/base/threads.h"

namespace supple::neural {
namespace {

using Eigen::Index;

/// Number of designs that are prepared, and thus in memory, at the same time.
constexpr std::size_t designs_at_once = 256;
/// Number of strains of one task for each order. A task takes some 10 ms for a large network, after which stop requests
/// are checked.
constexpr Index strains_of_task[] = {192, 96, 48};

/// Consecutive strains of one design: begin ... end - 1.
struct Range {
  std::size_t design;  ///< index into the batch's designs
  Index begin;
  Index end;
};
/// A part of one range.
struct Piece {
  std::size_t group;  ///< index of the range
  Index begin;
  Index end;
};
using Task = std::vector<Piece>;

/// The ranges of consecutive strains that have equal designs.
std::vector<Range> equal_designs(const Batch& batch) {
  const Index strains = batch.strains.cols();
  const auto& designs = batch.designs;
  if (designs.size() == 1) return {{0, 0, strains}};
  std::vector<Range> ranges;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const auto at = static_cast<Index>(i);
    if (!ranges.empty() && designs[ranges.back().design] == designs[i]) {
      ranges.back().end = at + 1;
    } else {
      ranges.push_back({i, at, at + 1});
    }
  }
  return ranges;
}

/// Divides the strains of the ranges first ... last - 1 into tasks of at most max_strains strains.
std::vector<Task> tasks_of(const std::vector<Range>& groups, std::size_t first, std::size_t last, Index max_strains) {
  std::vector<Task> tasks(1);
  Index remaining = max_strains;
  for (std::size_t group = first; group < last; ++group) {
    for (Index begin = groups[group].begin; begin < groups[group].end;) {
      if (remaining == 0) {
        tasks.emplace_back();
        remaining = max_strains;
      }
      const Index end = std::min(groups[group].end, begin + remaining);
      tasks.back().push_back({group, begin, end});
      remaining -= end - begin;
      begin = end;
    }
  }
  return tasks;
}

class BatchEvaluation {
 public:
  BatchEvaluation(const Model& model, const Evaluator& evaluator, const Batch& batch, const Execution& execution)
      : model_(model), evaluator_(evaluator), batch_(batch), execution_(execution), groups_(equal_designs(batch)) {
    const Index n = batch.strains.cols();
    result_.values.energy_density.resize(n);
    result_.values.stress.resize(3, batch.order >= Order::stress ? n : 0);
    result_.values.tangent.resize(6, batch.order >= Order::tangent ? n : 0);
    result_.trust.resize(static_cast<std::size_t>(n));
  }

  BatchResult run() {
    for (std::size_t first = 0; first < groups_.size(); first += designs_at_once) {
      const auto last = std::min(groups_.size(), first + designs_at_once);
      prepare(first, last);
      const auto tasks = tasks_of(groups_, first, last, strains_of_task[static_cast<int>(batch_.order)]);
      for_each(tasks.size(), "evaluation", [&](std::size_t i) {
        Evaluator::Workspace workspace;
        Evaluation part;
        for (const auto& piece : tasks[i]) evaluate(piece, *designs_[piece.group - first], workspace, part);
        return tasks[i].back().end - tasks[i].front().begin;
      });
    }
    if (execution_.cost) {
      execution_.cost->add_quantity("designs", static_cast<double>(groups_.size()));
      execution_.cost->add_quantity("strains", static_cast<double>(batch_.strains.cols()));
    }
    check_finite();
    return std::move(result_);
  }

 private:
  void prepare(std::size_t first, std::size_t last) {
    designs_.clear();
    designs_.resize(last - first);
    for_each(last - first, "designs", [&](std::size_t i) {
      designs_[i] = std::make_unique<Evaluator::Design>(evaluator_.design(batch_.designs[groups_[first + i].design]));
      return Index{0};
    });
  }

  void evaluate(const Piece& piece, const Evaluator::Design& design, Evaluator::Workspace& workspace,
                Evaluation& part) {
    const Index count = piece.end - piece.begin;
    evaluator_.evaluate(design, batch_.strains.middleCols(piece.begin, count), batch_.order, workspace, part);
    auto& values = result_.values;
    values.energy_density.segment(piece.begin, count) = part.energy_density;
    if (values.stress.cols() > 0) values.stress.middleCols(piece.begin, count) = part.stress;
    if (values.tangent.cols() > 0) values.tangent.middleCols(piece.begin, count) = part.tangent;
    const auto& parameters = batch_.designs[groups_[piece.group].design];
    const ErrorBars bars(model_, evaluator_, design, parameters, false);
    for (Index i = piece.begin; i < piece.end; ++i) {
      auto& trust = result_.trust[static_cast<std::size_t>(i)];
      if (values.stress.cols() > 0) {
        trust = bars.at_strain(batch_.strains.col(i), values.energy_density[i], values.stress.col(i));
      } else {
        trust.in_range =
            in_range(model_, parameters, batch_.strains.col(i), values.energy_density[i], design.rest_stiffness());
      }
    }
  }

  /// Calls work(i) for i in [0, n) in parallel, and bills its time. work(i) returns the number of strains that it has
  /// evaluated.
  template <class Work>
  void for_each(std::size_t n, const char* stage, Work work) {
    parallel_for(static_cast<int>(n), [&](int i) {
      execution_.cancellation.throw_if_requested();
      CostLedger ledger;
      Index strains = 0;
      {
        const StageTimer timer(&ledger, stage);
        strains = work(static_cast<std::size_t>(i));
      }
      const std::lock_guard lock(mutex_);
      done_ += strains;
      if (execution_.cost) execution_.cost->merge(ledger);
      if (execution_.progress) {
        execution_.progress->report(static_cast<double>(done_) / static_cast<double>(batch_.strains.cols()), stage);
      }
    });
  }

  void check_finite() const {
    const auto& values = result_.values;
    for (Index i = 0; i < values.energy_density.cols(); ++i) {
      const bool finite = std::isfinite(values.energy_density[i]) &&
                          (values.stress.cols() == 0 || values.stress.col(i).allFinite()) &&
                          (values.tangent.cols() == 0 || values.tangent.col(i).allFinite());
      if (finite) continue;
      const std::string text = "The model gives no finite value for strain " + std::to_string(i) + ".";
      throw Error("model.not_finite", text, {{"green_strain/" + std::to_string(i), text}});
    }
  }

  const Model& model_;
  const Evaluator& evaluator_;
  const Batch& batch_;
  const Execution& execution_;
  const std::vector<Range> groups_;
  std::vector<std::unique_ptr<Evaluator::Design>> designs_;  ///< designs of the ranges that are being evaluated
  BatchResult result_;
  std::mutex mutex_;  ///< protects the bill and the progress
  Index done_ = 0;    ///< number of strains that have been evaluated
};

}  // namespace

void check_designs(const Model& model, std::span<const std::vector<double>> designs, const std::string& field,
                   bool several) {
  constexpr std::size_t max_details = 20;
  const auto expected = static_cast<std::size_t>(model.network.shape.parameters);
  const std::string wanted = std::to_string(expected) + (expected == 1 ? " number" : " numbers");
  std::vector<Error::Detail> details;
  for (std::size_t i = 0; i < designs.size() && details.size() < max_details; ++i)
    if (designs[i].size() != expected)
      details.push_back({several ? field + "/" + std::to_string(i) : field,
                         "must be " + wanted + ", not " + std::to_string(designs[i].size())});
  if (!details.empty())
    throw Error("model.parameter_count", "A design of the model " + model.id + " is " + wanted + ".", details);
}

void check_batch(const Model& model, const Batch& batch) {
  check_designs(model, batch.designs, "parameters", true);
  const auto strains = static_cast<std::size_t>(batch.strains.cols());
  if (batch.designs.size() != 1 && batch.designs.size() != strains) {
    const std::string text = "There are " + std::to_string(batch.designs.size()) + " designs for " +
                             std::to_string(strains) + " strains; there must be one, or one for each.";
    throw Error("model.design_count", text, {{"parameters", text}});
  }
}

BatchResult evaluate_batch(const Model& model, const Evaluator& evaluator, const Batch& batch,
                           const Execution& execution) {
  return BatchEvaluation(model, evaluator, batch, execution).run();
}

}  // namespace supple::neural
