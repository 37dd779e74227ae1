#pragma once

#include "search_front.h"

// The emission of windows by source points and by vertices that bend shortest paths.
namespace supple::surface {

/// Improves the vertices near a source, and emits windows through the sides of its face, or queues its vertex.
void emit_from_source(SearchFront& front, std::int32_t source);
/// Emits windows from a vertex into the angles to which a shortest path may turn.
void emit_from_vertex(SearchFront& front, std::int32_t v);

}  // namespace supple::surface
