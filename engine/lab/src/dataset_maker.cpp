#include "supple/lab/dataset_maker.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <iterator>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/base/threads.h"
#include "supple/dataset/dataset_file.h"
#include "supple/dataset/journal.h"
#include "supple/lab/design_sequence.h"

namespace supple::lab {
namespace {

using dataset::Dataset;

/// Throws "dataset.different_recipe" if the finished file at `path` is another data set.
void check_finished(const std::filesystem::path& path, const Dataset& found, const Dataset& wanted) {
  std::vector<Error::Detail> details;
  for (auto& difference : dataset::differences(found.recipe, wanted.recipe))
    details.push_back({"recipe", std::move(difference)});
  if (!(found.selection == wanted.selection))
    details.push_back({"selection", "the first design, the number of designs or the shard is another"});
  if (!details.empty())
    throw Error("dataset.different_recipe",
                path.string() + " is a data set of other settings: " + details.front().message +
                    ". Choose another output file.",
                details);
}

/// Computes the design with this index.
using DesignSource = std::function<dataset::Design(std::int64_t index)>;

/// Computes designs on several threads, which take them in the order of their indices.
class Run {
 public:
  Run(DesignSource design_of, dataset::Journal& journal, std::vector<std::int64_t> indices,
      const CancellationToken& cancellation, MakeListener* listener)
      : design_of_(std::move(design_of)),
        journal_(journal),
        indices_(std::move(indices)),
        cancellation_(cancellation),
        listener_(listener) {}

  /// Returns the designs that were finished: all, or fewer if a stop was requested.
  std::vector<dataset::Design> run() {
    const int workers = std::max(1, std::min(thread_count(), static_cast<int>(indices_.size())));
    // There is one task for each thread instead of one for each design. With the latter the order of the designs, and
    // so the content of an interrupted data set, would be arbitrary.
    parallel_for(workers, [this](int) { work(); });
    return std::move(done_);
  }

 private:
  void work() {
    while (!failed_ && !cancellation_.requested()) {
      const std::size_t next = next_++;
      if (next >= indices_.size()) return;
      try {
        finish(design_of_(indices_[next]));
      } catch (const Cancelled&) {
        return;
      } catch (...) {
        failed_ = true;
        throw;
      }
    }
  }

  void finish(dataset::Design design) {
    const std::lock_guard lock(mutex_);
    journal_.append(design);
    if (listener_) listener_->design_done(design);
    done_.push_back(std::move(design));
  }

  const DesignSource design_of_;
  dataset::Journal& journal_;
  const std::vector<std::int64_t> indices_;
  const CancellationToken& cancellation_;
  MakeListener* listener_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;
  std::vector<dataset::Design> done_;
};

std::vector<dataset::Design>::const_iterator find_design(const Dataset& data, std::int64_t index) {
  return std::find_if(data.designs.begin(), data.designs.end(),
                      [index](const dataset::Design& design) { return design.index == index; });
}

/// Computes the designs with the indices in `missing` that are not in the journal beside `path`, and adds them to it.
/// If no stop is requested, writes the data set to `path` and removes the journal.
MakeResult complete(Dataset data, std::vector<std::int64_t> missing, const std::filesystem::path& path,
                    const DesignSource& design_of, std::int64_t states_per_design,
                    const CancellationToken& cancellation, MakeListener* listener) {
  dataset::Journal journal(dataset::journal_path(path), data.recipe, data.selection);
  data.designs = journal.content().data.designs;
  std::erase_if(missing, [&](std::int64_t index) { return find_design(data, index) != data.designs.end(); });
  const std::size_t missing_count = missing.size();
  if (listener) {
    listener->started(static_cast<std::int64_t>(missing.size() + data.designs.size()),
                      static_cast<std::int64_t>(data.designs.size()), missing.empty() ? 0 : states_per_design);
  }
  auto computed = Run(design_of, journal, std::move(missing), cancellation, listener).run();
  MakeResult result;
  result.computed = static_cast<std::int64_t>(computed.size());
  std::move(computed.begin(), computed.end(), std::back_inserter(data.designs));
  std::sort(data.designs.begin(), data.designs.end(),
            [](const dataset::Design& a, const dataset::Design& b) { return a.index < b.index; });
  result.designs = static_cast<std::int64_t>(data.designs.size());
  result.finished = result.computed == static_cast<std::int64_t>(missing_count);
  if (result.finished) {
    dataset::write_dataset(path, data);
    journal.remove();
  }
  return result;
}

std::int64_t planned_states(const DatasetOptions& options, std::int64_t index) {
  std::int64_t states = 0;
  for (const PlannedPath& planned : planned_design(options, index).paths) states += planned.path.planned;
  return states;
}

/// Whether the engine still computes the same stress for the first state of the first path of each kind of load.
bool is_current(const DatasetOptions& options, const dataset::Design& design, double tolerance,
                const CancellationToken& cancellation) {
  PlannedDesign planned = planned_design(options, design.index);
  std::vector<std::size_t> paths;
  for (std::size_t k = 0; k < planned.paths.size(); ++k) {
    const auto& kind = planned.paths[k].path;
    const bool tension = kind.end_stretch > 1;
    const bool is_covered = std::any_of(paths.begin(), paths.end(), [&](std::size_t other) {
      const auto& before = planned.paths[other].path;
      return before.kind == kind.kind && (before.end_stretch > 1) == tension;
    });
    if (!is_covered) paths.push_back(k);
  }
  PlannedDesign probe = planned;
  probe.paths.clear();
  for (const std::size_t k : paths) {
    probe.paths.push_back(planned.paths[k]);
    probe.paths.back().stretches.resize(1);
    probe.paths.back().path.planned = 1;
  }
  const dataset::Design now = simulate_design(options, probe, cancellation);
  if (now.rejected()) return false;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const auto find = [](const dataset::Design& in, std::size_t path) {
      return std::find_if(in.rows.begin(), in.rows.end(), [&](const dataset::Row& row) {
        return row.path == static_cast<std::int32_t>(path) && row.position == 0;
      });
    };
    const auto before = find(design, paths[k]), after = find(now, k);
    if (before == design.rows.end() || after == now.rows.end()) return false;
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      difference += std::pow(after->stress[i] - before->stress[i], 2);
      size += std::pow(after->stress[i], 2);
    }
    // The negated condition makes NaN a change.
    if (!(difference <= tolerance * tolerance * size)) return false;
  }
  return true;
}

bool has_failed(const dataset::Design& design) {
  return design.rejected() || std::any_of(design.paths.begin(), design.paths.end(),
                                          [](const dataset::Path& path) { return path.reached < path.planned; });
}

bool has_contacts(const dataset::Design& design) {
  return std::any_of(design.rows.begin(), design.rows.end(), [](const dataset::Row& row) { return row.contacts > 0; });
}

}  // namespace

MakeResult make_dataset(const DatasetOptions& options, const std::filesystem::path& path,
                        const CancellationToken& cancellation, MakeListener* listener) {
  check(options);
  Dataset data{recipe_of(options), selection_of(options), {}};
  if (std::filesystem::exists(path)) {
    const Dataset found = dataset::read_dataset(path);
    check_finished(path, found, data);
    // A journal remains if a run was killed after it had written the file.
    std::filesystem::remove(dataset::journal_path(path));
    return {static_cast<std::int64_t>(found.designs.size()), 0, true};
  }
  const auto simulate = [&](std::int64_t index) {
    return simulate_design(options, planned_design(options, index), cancellation, listener);
  };
  const std::int64_t states = options.designs > 0 ? planned_states(options, options.first) : 0;
  std::vector<std::int64_t> indices = data.selection.indices();
  return complete(std::move(data), std::move(indices), path, simulate, states, cancellation, listener);
}

RenewResult renew_dataset(const Dataset& old, const RenewOptions& renew, const std::filesystem::path& path,
                          const CancellationToken& cancellation, MakeListener* listener) {
  if (!(renew.tolerance > 0 && renew.tolerance < 1)) {
    const std::string message = "must lie between 0 and 1, but is " + number_text(renew.tolerance);
    throw Error("dataset.invalid_option", "Option tolerance " + message + ".", {{"tolerance", message}});
  }
  const DatasetOptions options = options_of(old.recipe, old.selection);
  check(options);
  if (const auto differing = dataset::differences(old.recipe, recipe_of(options)); !differing.empty()) {
    throw Error("dataset.different_recipe",
                "The engine's family is not that of the data set any more: " + differing.front() + ".",
                {{"recipe", differing.front()}});
  }
  Dataset data{old.recipe, old.selection, {}};
  if (std::filesystem::exists(path)) {
    const Dataset found = dataset::read_dataset(path);
    check_finished(path, found, data);
    std::filesystem::remove(dataset::journal_path(path));
    return {static_cast<std::int64_t>(found.designs.size()), 0, true};
  }
  std::atomic<std::int64_t> renewed = 0;
  const auto source = [&](std::int64_t index) {
    const auto before = find_design(old, index);
    if (!has_failed(*before) && !(renew.contacts && has_contacts(*before)) &&
        is_current(options, *before, renew.tolerance, cancellation)) {
      return *before;
    }
    ++renewed;
    return simulate_design(options, planned_design(options, index), cancellation, listener);
  };
  const std::int64_t states = options.designs > 0 ? planned_states(options, options.first) : 0;
  std::vector<std::int64_t> indices;
  for (const dataset::Design& design : old.designs) indices.push_back(design.index);
  const MakeResult made = complete(std::move(data), std::move(indices), path, source, states, cancellation, listener);
  return {made.designs, renewed, made.finished};
}

}  // namespace supple::lab
