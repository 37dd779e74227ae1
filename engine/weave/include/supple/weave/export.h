#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "supple/weave/weave.h"

namespace supple::weave {

/// Deformed polylines (mm) as a Wavefront OBJ file: a line element for each strand, in their order. Numbers read back
/// as the same doubles.
std::string write_obj(const std::vector<std::vector<Eigen::Vector3d>>& strands);

/// The same as a VTK unstructured grid (VTU, ASCII) of polylines (cell type 4) with the cell data "strand" (index) and
/// "radius" (mm), from which VTK draws tubes. `strands` are those of `weave`.
std::string write_vtu(const Weave& weave, const std::vector<std::vector<Eigen::Vector3d>>& strands);

}  // namespace supple::weave
