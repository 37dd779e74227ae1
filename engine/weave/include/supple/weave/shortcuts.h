#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/base/execution.h"
#include "supple/weave/homogenization.h"
#include "supple/weave/weave.h"

// Functions for programs that have matrices, and one question about a weave. numerics::rows_of makes a matrix of a
// deformed polyline.
namespace supple::weave {

/// Lays out open strands of one radius (mm) through the rows of matrices, n x 2, mm. All crossings are found, and every
/// member of them is fused. Throws std::invalid_argument if a matrix does not have two columns, and what StrandCurve
/// and find_crossings throw.
Weave weave_of(const std::vector<Eigen::MatrixXd>& strands, double radius = 0.25, const Material& material = {},
               const Execution& execution = {});

/// Strains a periodic weave along `directions` directions that are spread evenly over half a turn; see `homogenize`.
std::vector<DirectionalResponse> homogenize_over_half_turn(const Weave& weave, int directions = 24, double strain = 0.1,
                                                           const Execution& execution = {});

/// The Young's moduli of responses, N/m, one for each direction.
Eigen::VectorXd youngs_moduli(const std::vector<DirectionalResponse>& responses);
/// The Poisson's ratios of responses, one for each direction.
Eigen::VectorXd poisson_ratios(const std::vector<DirectionalResponse>& responses);

}  // namespace supple::weave
