#pragma once

namespace supple::microscale {

// Limits that equilibrium paths of cells and of parts share.

/// Limit of the length of a cubic extrapolation, divided by the length of the load step from which it is made.
inline constexpr double max_extrapolation = 2.5;
/// The factorization is used again if a Newton step has reduced the gradient's norm by this factor. A step with the old
/// factorization costs about a tenth of a new factorization.
inline constexpr double reuse_contraction = 0.25;
/// Limit of the factor by which a step that leaves an unstable state may be lengthened. The curvature of the energy
/// along the buckling of a beam is about 1e-8 of the Hessian's scale, so that such steps are often far too short.
inline constexpr double max_expansion = 64;

}  // namespace supple::microscale
