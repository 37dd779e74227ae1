#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "supple/json/answers.h"
#include "supple/json/embedded_system_requests.h"

/// The answer of elastic networks on surfaces as JSON text; it throws what those of answers.h throw.
namespace supple::json {

/// `network` is the one that was relaxed, with the points where they started. `triangles` is null where the answer has
/// none. `mesh` is the surface at the end.
std::string write_embedded_system(const EmbeddedSystemRequest& request, const surface::TriangleMesh& mesh,
                                  const embedded::Network& network, const embedded::Relaxation& relaxation,
                                  const std::vector<std::array<std::int32_t, 3>>* triangles, const Bill& bill);

/// Limit for the points of a network, and for the vertices of a deformable surface, in an intermediate result: the
/// positions of larger ones are left out.
inline constexpr std::size_t max_partial_positions = 5000;

/// The network after an iteration, with the surface's vertices where the surface `moves`.
std::string write_partial_relaxation(int iteration, const embedded::RelaxationStep& step,
                                     const surface::TriangleMesh& mesh, std::span<const surface::SurfacePoint> points,
                                     bool moves);

}  // namespace supple::json
