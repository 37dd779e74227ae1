#pragma once

#include <filesystem>

#include "supple/dataset/dataset.h"

namespace supple::dataset {

struct FileOptions {
  /// Whether strains, stresses and the other real columns of the rows are in single precision. Designs stay in double.
  bool single_precision = false;
  bool compressed = false;  ///< whether columns are written in chunks whose bytes are shuffled and deflated
};

/// Writes one HDF5 file (layout: docs/datasets.md). The file appears completely or not at all, because it is written
/// under another name, synchronized and then renamed. The same data give the same bytes. Throws "file.write_failed".
void write_dataset(const std::filesystem::path& path, const Dataset& data, const FileOptions& options = {});

/// Reads a data set. Throws "file.unreadable" if there is no such file, if its content does not have its checksum, if
/// it is no HDF5 file or has another layout, or if its columns contradict each other. Files that were written before
/// data sets had checksums are read without one.
Dataset read_dataset(const std::filesystem::path& path);

// HDF5's library is not thread-safe. Only one thread at a time may be in these functions.

}  // namespace supple::dataset
