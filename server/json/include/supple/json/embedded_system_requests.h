#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "supple/embedded/network.h"
#include "supple/embedded/relaxation.h"
#include "supple/json/requests.h"

/// The request of elastic networks on surfaces as a type; it is read like those of requests.h and throws the same.
/// Whether points lie on the mesh and springs join points that there are is not asked here.
namespace supple::json {

/// One point in each face.
struct PointsInFaces {
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
};

/// Random points that keep their distance.
struct PoissonDiskPoints {
  double radius = 0;  ///< mesh units
  std::uint64_t seed = 1;
};

/// Springs between neighbours.
struct SpringBuilder {
  enum class Kind { adjacent_faces, voronoi_dual } kind = Kind::adjacent_faces;
  double rest_length = 0;  ///< mesh units
  double weight = 1;       ///< energy per squared mesh unit
};

struct EmbeddedSystemRequest {
  std::string mesh;
  std::variant<std::vector<PointSpec>, PointsInFaces, PoissonDiskPoints> points;
  std::variant<std::vector<embedded::Spring>, SpringBuilder> springs;
  std::vector<std::int32_t> fixed_points;
  embedded::RelaxationOptions options;  ///< without an observer
  double deadline = 0;                  ///< seconds; set also where the request leaves it out
};
EmbeddedSystemRequest parse_embedded_system(std::string_view body, const Limits& limits);

}  // namespace supple::json
