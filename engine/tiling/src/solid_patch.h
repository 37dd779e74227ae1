#pragma once

#include <string>
#include <vector>

#include "beams.h"
#include "supple/tiling/export.h"

namespace supple::tiling {

/// The solid of first x second cells in mm, centred at the origin, with beams of full width along the rim. Throws
/// "tiling.export_option".
std::vector<Face> solid_patch(const Structure& structure, const ExportOptions& options);

/// The number rounded to `digits` decimals, without zeros at the end, whatever the locale.
std::string decimal(double value, int digits = 5);

}  // namespace supple::tiling
