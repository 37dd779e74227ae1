#pragma once

#include <vector>

#include "cell_model.h"
#include "supple/numerics/system.h"

namespace supple::microscale {

/// The energy of a patch with prescribed macroscopic strain, as a function of the periodic displacements and of the
/// free components of F. Node 0 is fixed, because a translation of the patch costs no energy. The components of F are
/// the border of the bordered Hessian.
using CellSystem = numerics::System<CellState>;

/// The free directions of F: orthonormal matrices, as (xx, xy, yx, yy).
using FreeStrains = std::vector<Eigen::Vector4d>;

/// `model` and the execution's cost ledger must outlive the system. `x` are coordinates as in cell_coordinates.h.
CellSystem cell_system(CellModel& model, Eigen::VectorXd x, const FreeStrains& free, const Execution& execution);

}  // namespace supple::microscale
