#pragma once

#include <string>

#include "supple/weave/toolpath.h"

namespace supple::weave {

/// A toolpath as G-code: RepRap flavour, millimetres, absolute positions and extrusion, one line for each point, a
/// comment before each move. Begins with heating, homing and the profile's own lines, ends with the nozzle above the
/// print and everything switched off. Positions to 0.001 mm, filament to 0.00001 mm. O(points).
std::string to_gcode(const Toolpath& toolpath, const PrinterProfile& profile);

}  // namespace supple::weave
