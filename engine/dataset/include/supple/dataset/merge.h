#pragma once

#include <filesystem>
#include <vector>

#include "supple/dataset/dataset.h"

namespace supple::dataset {

/// Reads a finished data set, or what an unfinished one holds so far: the file `path` itself, or its journal if there
/// is no such file. Throws "file.unreadable".
Dataset read_finished_or_partial(const std::filesystem::path& path);

/// Makes one data set of several with the same recipe. They are shards of one selection, or consecutive ranges of the
/// sequence of designs.
///
/// Designs are sorted by index. The selection becomes the smallest range of the sequence that contains all selections,
/// so that merged shards equal the data set that is made without shards. Throws "dataset.different_recipe" (which names
/// the settings), "dataset.duplicate_design" (which names the design) and, unless `allow_missing`,
/// "dataset.missing_designs".
Dataset merge(std::vector<Dataset> parts, bool allow_missing = false);

/// Reads the parts in these files, finished or not, and merges them. Designs may be missing. Throws what
/// `read_finished_or_partial` and `merge` throw.
Dataset read_parts(const std::vector<std::filesystem::path>& files);

}  // namespace supple::dataset
