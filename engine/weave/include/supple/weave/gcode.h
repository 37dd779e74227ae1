#pragma once

#include <string>

#include "supple/weave/toolpath.h"

namespace supple::weave {

/// Writes a toolpath as G-code of the RepRap flavour, in millimetres, with absolute positions and extrusion, one line
/// for each point and a comment before each move. It begins with heating, homing and the profile's own lines, and ends
/// with the nozzle above the print, parked if the profile says so, and everything switched off. Positions are exact to
/// 0.001 mm, and filament to 0.00001 mm. O(points).
std::string to_gcode(const Toolpath& toolpath, const PrinterProfile& profile);

}  // namespace supple::weave
