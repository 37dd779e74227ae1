#pragma once

#include <string>

#include "supple/base/execution.h"
#include "supple/tiling/structure.h"

namespace supple::tiling {

/// The patch that is written: `first` x `second` cells of a structure (each from 1 to 100). Lengths are in millimetres.
struct ExportOptions {
  int first = 2;
  int second = 2;
  double height = 1.0;  ///< height of the extrusion, mm; used by STL only
};

/// The solid as one SVG path with holes (even-odd fill), true to scale in millimetres. The root's attribute
/// data-translations has the x and y of the two translations that repeat the cell, in the file's coordinates.
std::string write_svg(const Structure& structure, const ExportOptions& options = {}, const Execution& execution = {});
/// The outlines of the solid patch and of its holes as closed LWPOLYLINEs, in AutoCAD R2000 ASCII and millimetres.
std::string write_dxf(const Structure& structure, const ExportOptions& options = {}, const Execution& execution = {});
/// The patch extruded by `height`: a closed, consistently oriented surface, binary STL, millimetres.
std::string write_stl(const Structure& structure, const ExportOptions& options = {}, const Execution& execution = {});

// All of them throw "tiling.export_option", which names an option out of range with its limits. The union of the beams
// and the triangles of the caps cannot be interrupted. If this process has helpers (`helper_processes`), large patches
// and all STL files are therefore written in a helper: a stop request then ends them at once, and what
// `HelperProcesses` throws is thrown. 100 x 100 cells take seconds, and STL files of some families take minutes.

}  // namespace supple::tiling
