#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// An OBJ file of the paths of geodesics or traces: a `v` line for each point and an `l` line for each path. `paths` is
/// an array of paths, each an array of points with "position". Paths with fewer than two points are omitted.
std::string paths_as_obj(const nlohmann::json& paths);

}  // namespace supple::cli
