#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "supple/embedded/network.h"
#include "supple/embedded/network_plan.h"
#include "supple/embedded/relaxation.h"
#include "supple/json/requests.h"

/// The request of elastic networks on surfaces as a type; it is read like those of requests.h and throws the same.
/// Whether points lie on the mesh and springs join existing points is not checked here.
namespace supple::json {

inline constexpr auto relaxation_method_names =
    names_of<embedded::RelaxationMethod>({{embedded::RelaxationMethod::newton, "newton"},
                                          {embedded::RelaxationMethod::lbfgs, "lbfgs"},
                                          {embedded::RelaxationMethod::gradient_descent, "gradient_descent"}});
inline constexpr auto spring_length_names = names_of<embedded::SpringLength>(
    {{embedded::SpringLength::geodesic, "geodesic"}, {embedded::SpringLength::euclidean, "euclidean"}});

struct EmbeddedSystemRequest {
  std::string mesh;
  std::variant<std::vector<PointSpec>, embedded::PointsInFaces, embedded::PoissonDiskPoints> points;
  std::variant<std::vector<embedded::Spring>, embedded::NeighbourSprings> springs;
  std::vector<std::int32_t> fixed_points;
  std::variant<std::vector<std::array<std::int32_t, 3>>, embedded::DualTriangles> triangles{};
  embedded::MembraneMaterial material{};
  double rest_scale = 1;                ///< rest lengths of the triangles, as a factor of their lengths at the start
  embedded::RelaxationOptions options;  ///< without an observer
  std::vector<PlacedPoint> points_in_space;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
EmbeddedSystemRequest parse_embedded_system(std::string_view body, const Limits& limits,
                                            const CancellationToken& cancellation = {});

}  // namespace supple::json
