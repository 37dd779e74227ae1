#pragma once

#include <filesystem>
#include <vector>

#include "supple/dataset/dataset.h"

namespace supple::dataset {

/// A finished data set, or what an unfinished one holds so far: `path` itself, or else its journal. Throws
/// "file.unreadable".
Dataset read_finished_or_partial(const std::filesystem::path& path);

/// One data set of several with the same recipe: shards of one selection, or consecutive stretches of the sequence.
///
/// Designs are sorted by index; the selection becomes the least stretch of the sequence that holds all of theirs, so
/// that merged shards equal the data set that was made without shards. Throws "dataset.different_recipe" (settings
/// named), "dataset.duplicate_design" (design named) and, unless `allow_missing`, "dataset.missing_designs".
Dataset merge(std::vector<Dataset> parts, bool allow_missing = false);

/// The merged parts that stand in these files, finished or not; designs may be missing. Throws what
/// `read_finished_or_partial` and `merge` throw.
Dataset read_parts(const std::vector<std::filesystem::path>& files);

}  // namespace supple::dataset
