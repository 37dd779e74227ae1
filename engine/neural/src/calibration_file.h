#pragma once

#include <optional>

#include "supple/files/hdf5_file.h"
#include "supple/neural/calibration.h"

namespace supple::neural {

/// The group "calibration" of a model's file; nothing where there is none.
void write_calibration(files::Hdf5Writer& file, const std::optional<Calibration>& calibration);

/// Nothing from files without one, such as of older programs. Throws "file.unreadable" where sizes do not fit a network
/// of so many parameters or numbers are not finite.
std::optional<Calibration> read_calibration(const files::Hdf5Reader& file, int parameters);

}  // namespace supple::neural
