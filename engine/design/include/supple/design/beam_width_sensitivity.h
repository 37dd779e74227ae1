#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/inverse_design.h"

namespace supple::design {

/// The relative error of the beam width for which the sensitivity of a design is said, as printers make it.
inline constexpr double beam_width_error = 0.05;

/// The tangent stiffness at rest of the structure at parameters, d stress / d (E_xx, E_yy, 2 E_xy) in MPa, if its beams
/// are wider by a factor and its cell remains as large. Throws what the tiling or the simulation throws.
using RestTangent =
    std::function<Eigen::Matrix3d(const Eigen::VectorXd& parameters, double width_factor, const Execution& execution)>;

/// Relative changes of a design's profile at rest, root mean square with the weights of the target: of the stiffness or
/// Poisson's ratio (relative to at least 0.1) over direction, and of the initial modulus along the load for stress over
/// strain. None if there is no such structure, for example because its holes close.
struct BeamWidthSensitivity {
  std::optional<double> wider;     ///< beams wider by `beam_width_error`
  std::optional<double> narrower;  ///< beams narrower by it
};

/// The sensitivity of each profile of the design. Takes three linear solves, of the structure itself and of the two
/// with other beams. If the deadline or a limit of memory stops it, nothing is known.
std::vector<BeamWidthSensitivity> beam_width_sensitivity(const Design& design, const RestTangent& rest_tangent,
                                                         const Execution& execution = {});

}  // namespace supple::design
