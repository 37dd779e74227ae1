#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// The paths of geodesics or traces as one OBJ file: a `v` line for each point and an `l` line for each path.
/// `paths` is an array of paths, each an array of points with "position". Paths of fewer than two points are left out.
std::string paths_as_obj(const nlohmann::json& paths);

}  // namespace supple::cli
