#include "supple/lab/dataset_maker.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/threads.h"
#include "supple/dataset/dataset_file.h"
#include "supple/dataset/journal.h"
#include "supple/lab/design_sequence.h"

namespace supple::lab {
namespace {

using dataset::Dataset;

/// Throws where the finished file at `path` is another data set.
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

/// The designs of one run, computed by several threads in the order of their indices.
class Run {
 public:
  Run(const DatasetOptions& options, dataset::Journal& journal, std::vector<std::int64_t> indices,
      const CancellationToken& cancellation, MakeListener* listener)
      : options_(options),
        journal_(journal),
        indices_(std::move(indices)),
        cancellation_(cancellation),
        listener_(listener) {}

  /// The designs that were finished; fewer than asked for where a stop was requested.
  std::vector<dataset::Design> run() {
    const int workers = std::max(1, std::min(thread_count(), static_cast<int>(indices_.size())));
    // Not one task for each design: the order of designs, and thus what an interrupted run holds, would be arbitrary.
    parallel_for(workers, [this](int) { work(); });
    return std::move(done_);
  }

 private:
  void work() {
    while (!failed_ && !cancellation_.requested()) {
      const std::size_t next = next_++;
      if (next >= indices_.size()) return;
      try {
        finish(simulate_design(options_, planned_design(options_, indices_[next]), cancellation_, listener_));
      } catch (const Error& error) {
        if (cancellation_.requested() && error.code() != "file.write_failed") return;
        failed_ = true;
        throw;
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

  const DatasetOptions& options_;
  dataset::Journal& journal_;
  const std::vector<std::int64_t> indices_;
  const CancellationToken& cancellation_;
  MakeListener* listener_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;
  std::vector<dataset::Design> done_;
};

}  // namespace

MakeResult make_dataset(const DatasetOptions& options, const std::filesystem::path& path,
                        const CancellationToken& cancellation, MakeListener* listener) {
  check(options);
  Dataset data{recipe_of(options), selection_of(options), {}};
  if (std::filesystem::exists(path)) {
    const Dataset found = dataset::read_dataset(path);
    check_finished(path, found, data);
    // A run that ended between the file's appearance and the journal's end.
    std::filesystem::remove(dataset::journal_path(path));
    return {static_cast<std::int64_t>(found.designs.size()), 0, true};
  }
  dataset::Journal journal(dataset::journal_path(path), data.recipe, data.selection);
  data.designs = journal.content().data.designs;
  std::vector<std::int64_t> missing = dataset::missing_designs(data);
  if (listener) {
    std::int64_t states = 0;
    if (!missing.empty())
      for (const PlannedPath& planned : planned_design(options, missing.front()).paths) states += planned.path.planned;
    listener->started(static_cast<std::int64_t>(missing.size() + data.designs.size()),
                      static_cast<std::int64_t>(data.designs.size()), states);
  }
  auto computed = Run(options, journal, std::move(missing), cancellation, listener).run();
  MakeResult result;
  result.computed = static_cast<std::int64_t>(computed.size());
  std::move(computed.begin(), computed.end(), std::back_inserter(data.designs));
  std::sort(data.designs.begin(), data.designs.end(),
            [](const dataset::Design& a, const dataset::Design& b) { return a.index < b.index; });
  result.designs = static_cast<std::int64_t>(data.designs.size());
  result.finished = dataset::missing_designs(data).empty();
  if (result.finished) {
    dataset::write_dataset(path, data);
    journal.remove();
  }
  return result;
}

}  // namespace supple::lab
