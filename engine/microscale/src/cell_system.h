#pragma once

#include <vector>

#include "cell_model.h"
#include "supple/numerics/system.h"

namespace supple::microscale {

/// The energy of a patch with prescribed macroscopic strain, as a function of the periodic displacements and of the
/// free components of F. Node 0 is held, since a translation costs nothing; F is the border.
using CellSystem = numerics::System<CellState>;

/// Free directions of F: orthonormal matrices, as (xx, xy, yx, yy).
using FreeStrains = std::vector<Eigen::Vector4d>;

/// `model` and the ledger outlive the system. `x` are coordinates as in cell_coordinates.h.
CellSystem cell_system(CellModel& model, Eigen::VectorXd x, const FreeStrains& free, const Execution& execution);

}  // namespace supple::microscale
