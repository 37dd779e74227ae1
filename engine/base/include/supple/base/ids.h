#pragma once

#include <cstdint>

namespace supple {

/// Strongly typed indices into a mesh, for the engine's interfaces.
enum class VertexId : std::int32_t { none = -1 };
enum class FaceId : std::int32_t { none = -1 };
/// Halfedge 3 f + i runs from corner i to corner (i + 1) mod 3 of face f.
enum class HalfedgeId : std::int32_t { none = -1 };

constexpr std::int32_t index(VertexId v) { return static_cast<std::int32_t>(v); }
constexpr std::int32_t index(FaceId f) { return static_cast<std::int32_t>(f); }
constexpr std::int32_t index(HalfedgeId h) { return static_cast<std::int32_t>(h); }

}  // namespace supple
