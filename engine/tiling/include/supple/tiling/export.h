#pragma once

#include <string>

#include "supple/base/execution.h"
#include "supple/tiling/structure.h"

namespace supple::tiling {

/// What is written: `first` x `second` cells of a structure (each 1 to 100), lengths in millimetres.
struct ExportOptions {
  int first = 2;
  int second = 2;
  double height = 1.0;  ///< of the extrusion, mm; STL only
};

/// The solid as one SVG path with holes (even-odd fill), true to scale in millimetres.
std::string write_svg(const Structure& structure, const ExportOptions& options = {}, const Execution& execution = {});
/// Closed LWPOLYLINEs, AutoCAD R2000 ASCII, millimetres: outlines of the solid patch and its holes.
std::string write_dxf(const Structure& structure, const ExportOptions& options = {}, const Execution& execution = {});
/// The patch extruded by `height`: a closed, consistently oriented surface, binary STL, millimetres.
std::string write_stl(const Structure& structure, const ExportOptions& options = {}, const Execution& execution = {});

// All throw "tiling.export_option" where an option is out of range (named, with its limits). The union of the beams and
// the triangles of caps look for no stop request while they are made: where this process has helpers
// (`helper_processes`), large patches and all STL are written there, a stop ends them at once, and what
// `HelperProcesses` throws is thrown. Seconds for 100 x 100 cells, of some families minutes for STL.

}  // namespace supple::tiling
