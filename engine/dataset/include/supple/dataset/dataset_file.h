#pragma once

#include <filesystem>

#include "supple/dataset/dataset.h"

namespace supple::dataset {

struct FileOptions {
  /// Strains, stresses and the other real columns of the rows in single precision; designs stay in double.
  bool single_precision = false;
  bool compressed = false;  ///< columns in chunks, bytes shuffled, deflated
};

/// Writes one HDF5 file (layout: docs/datasets.md). The file appears whole or not at all: it is written beside its
/// place, synchronized and renamed. The same data give the same bytes. Throws "file.write_failed".
void write_dataset(const std::filesystem::path& path, const Dataset& data, const FileOptions& options = {});

/// Throws "file.unreadable": no such file, no HDF5, not of this layout, or columns that contradict each other.
Dataset read_dataset(const std::filesystem::path& path);

// HDF5's library is not made for several threads: one at a time may be in these functions.

}  // namespace supple::dataset
