#include "supple/dataset/merge.h"

#include <algorithm>
#include <string>
#include <utility>

#include "supple/base/error.h"
#include "supple/dataset/dataset_file.h"
#include "supple/dataset/journal.h"

namespace supple::dataset {
namespace {

constexpr std::size_t max_details = 20;

void check_recipes(const std::vector<Dataset>& parts) {
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const auto differing = differences(parts[0].recipe, parts[i].recipe);
    if (differing.empty()) continue;
    std::vector<Error::Detail> details;
    details.reserve(differing.size());
    for (const auto& difference : differing) details.push_back({"part " + std::to_string(i), difference});
    throw Error("dataset.different_recipe",
                "Parts 0 and " + std::to_string(i) + " were made with other settings: " + differing.front() + ".",
                details);
  }
}

}  // namespace

Dataset read_finished_or_partial(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path) && std::filesystem::exists(journal_path(path)))
    return Journal::read(journal_path(path)).data;
  if (path.extension() == ".partial") return Journal::read(path).data;
  return read_dataset(path);
}

Dataset merge(std::vector<Dataset> parts, bool allow_missing) {
  if (parts.empty()) throw Error("dataset.invalid_option", "There is nothing to merge.", {{"files", "at least one"}});
  check_recipes(parts);
  Dataset merged;
  merged.recipe = parts.front().recipe;
  std::int64_t first = parts.front().selection.first;
  std::int64_t end = first;
  for (auto& part : parts) {
    first = std::min(first, part.selection.first);
    end = std::max(end, part.selection.first + part.selection.count);
    std::move(part.designs.begin(), part.designs.end(), std::back_inserter(merged.designs));
  }
  merged.selection = {first, end - first, 0, 1};
  auto& designs = merged.designs;
  std::sort(designs.begin(), designs.end(), [](const Design& a, const Design& b) { return a.index < b.index; });
  const auto duplicate = std::adjacent_find(designs.begin(), designs.end(),
                                            [](const Design& a, const Design& b) { return a.index == b.index; });
  if (duplicate != designs.end())
    throw Error("dataset.duplicate_design",
                "Design " + std::to_string(duplicate->index) + " is in more than one part.");
  const auto missing = missing_designs(merged);
  if (missing.empty() || allow_missing) return merged;
  std::vector<Error::Detail> details;
  for (std::size_t i = 0; i < std::min(missing.size(), max_details); ++i)
    details.push_back({"design " + std::to_string(missing[i]), "is in no part"});
  throw Error("dataset.missing_designs",
              "The parts lack " + std::to_string(missing.size()) + " designs, the first of them " +
                  std::to_string(missing.front()) + ".",
              details);
}

Dataset read_parts(const std::vector<std::filesystem::path>& files) {
  std::vector<Dataset> parts;
  parts.reserve(files.size());
  for (const auto& file : files) parts.push_back(read_finished_or_partial(file));
  return merge(std::move(parts), true);
}

}  // namespace supple::dataset
