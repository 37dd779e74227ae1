#pragma once

#include <string>
#include <vector>

#include "beams.h"
#include "supple/tiling/export.h"

namespace supple::tiling {

/// The solid of first x second cells, beams along the rim at full width: mm, around the origin. Throws
/// "tiling.export_option".
std::vector<Face> solid_patch(const Structure& structure, const ExportOptions& options);

/// The shortest decimal with `digits` digits behind the point, whatever the locale.
std::string decimal(double value, int digits = 5);

}  // namespace supple::tiling
