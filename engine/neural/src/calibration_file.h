#pragma once

#include <optional>

#include "supple/files/hdf5_file.h"
#include "supple/neural/calibration.h"

namespace supple::neural {

/// Writes the group "calibration" of a model's file. Writes nothing if there is no calibration.
void write_calibration(files::Hdf5Writer& file, const std::optional<Calibration>& calibration);

/// Reads the group "calibration". Returns none if the file lacks it, as files of older programs do. Throws
/// "file.unreadable" if sizes do not fit a network with this number of parameters, or if a number is not finite.
std::optional<Calibration> read_calibration(const files::Hdf5Reader& file, int parameters);

}  // namespace supple::neural
