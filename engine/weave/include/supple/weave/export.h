#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "supple/weave/weave.h"

namespace supple::weave {

/// Writes deformed polylines (mm) as a Wavefront OBJ file, with a line element for each strand, in their order. Numbers
/// are read back as the same doubles.
std::string write_obj(const std::vector<std::vector<Eigen::Vector3d>>& strands);

/// Writes deformed polylines as a VTK unstructured grid (VTU, ASCII) of polylines (cell type 4). The cell data "strand"
/// (index) and "radius" (mm) let VTK draw tubes. `strands` are those of `weave`.
std::string write_vtu(const Weave& weave, const std::vector<std::vector<Eigen::Vector3d>>& strands);

}  // namespace supple::weave
