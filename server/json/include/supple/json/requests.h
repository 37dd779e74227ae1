#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/base/effect_switch.h"
#include "supple/base/priority.h"
#include "supple/json/limits.h"
#include "supple/json/name_table.h"
#include "supple/surface/geodesic_field.h"
#include "supple/surface/karcher_mean.h"
#include "supple/surface/mesh_io.h"
#include "supple/surface/mesh_repair.h"
#include "supple/surface/nearest_point.h"

/// The requests of api/openapi.yaml as types. Each `parse_*` reads a body completely and collects every fault: they
/// throw "request.not_utf8", "request.malformed_json", "request.too_deep", "request.too_many_values",
/// "request.limit_exceeded" and "request.invalid", the last with a JSON pointer for each field, and the error of a stop
/// request. Unknown fields are faults. Whether a point lies on the mesh is not checked here.
namespace supple::json {

/// The deadline in seconds of a body that has not been parsed yet, which bounds its parsing: its outermost field
/// "deadline", at most the largest one, or the default where that is missing or no number. O(bytes), about 1 ns each.
double peek_deadline(std::string_view body, const Limits& limits);
/// The outermost field "priority" of a body, which need not have been parsed yet; nothing where it is missing or no
/// name. Every parser checks the field, and nobody else reads it. O(bytes), about 1 ns each.
std::optional<Priority> peek_priority(std::string_view body);

/// A point as a client writes it.
struct PointSpec {
  bool by_vertex = false;
  std::int32_t index = 0;  ///< index of the vertex or of the face
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> position;  ///< position of a point in space, in place of all else
};

/// Where a point in space of a request lies on the surface. The route computes it for the answer.
struct PlacedPoint {
  std::string pointer;  ///< JSON pointer to the point in the request
  surface::NearestPoint nearest;
};

using supple::Switch;

inline constexpr auto field_method_names = names_of<surface::FieldMethod>(
    {{surface::FieldMethod::windows, "windows"}, {surface::FieldMethod::edge_graph, "edge_graph"}});
inline constexpr auto minimization_method_names =
    names_of<surface::MinimizationMethod>({{surface::MinimizationMethod::newton, "newton"},
                                           {surface::MinimizationMethod::lbfgs, "lbfgs"},
                                           {surface::MinimizationMethod::gradient_descent, "gradient_descent"}});
inline constexpr auto repair_names =
    names_of<surface::Repair>({{surface::Repair::weld, "weld"},
                               {surface::Repair::drop_degenerate, "drop_degenerate"},
                               {surface::Repair::drop_duplicates, "drop_duplicates"},
                               {surface::Repair::split_non_manifold, "split_non_manifold"}});

struct GeodesicsRequest {
  struct Pair {
    PointSpec from;
    PointSpec to;
    std::vector<PointSpec> known_path;
  };
  std::string mesh;
  std::vector<Pair> pairs;
  int derivatives = 0;
  bool paths = false;
  Switch mollifier = Switch::automatic;
  double mollifier_length = 1e-6;
  std::vector<PlacedPoint> points_in_space;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
GeodesicsRequest parse_geodesics(std::string_view body, const Limits& limits,
                                 const CancellationToken& cancellation = {});

struct GeodesicFieldRequest {
  std::string mesh;
  std::vector<PointSpec> sources;
  surface::FieldMethod method = surface::FieldMethod::windows;
  double relative_error = 0;
  double max_distance = std::numeric_limits<double>::infinity();
  std::vector<PlacedPoint> points_in_space;
  double deadline = 0;
};
GeodesicFieldRequest parse_geodesic_field(std::string_view body, const Limits& limits,
                                          const CancellationToken& cancellation = {});

struct KarcherMeanRequest {
  std::string mesh;
  std::vector<PointSpec> points;
  std::vector<double> weights;
  std::optional<PointSpec> start;
  double tolerance = 1e-9;
  int max_iterations = 200;
  int starts = 1;
  surface::MinimizationMethod method = surface::MinimizationMethod::newton;
  Switch kept_fields = Switch::automatic;
  std::vector<PlacedPoint> points_in_space;
  double deadline = 0;
};
KarcherMeanRequest parse_karcher_mean(std::string_view body, const Limits& limits,
                                      const CancellationToken& cancellation = {});

struct ExponentialMapRequest {
  std::string mesh;
  PointSpec start;
  std::vector<double> tangent;  ///< three numbers in space or two in the frame of the start's face
  bool trace = true;
  std::vector<PlacedPoint> points_in_space;
  double deadline = 0;
};
ExponentialMapRequest parse_exponential_map(std::string_view body, const Limits& limits,
                                            const CancellationToken& cancellation = {});

/// The key of {"key": "supple_..."}, whatever it is. No message repeats it.
std::string parse_sign_in(std::string_view body, const Limits& limits);

struct MeshUpload {
  surface::TriangleSoup soup;
  std::optional<surface::RepairOptions> repair;  ///< set where repairs are asked for
};
/// {"vertices", "faces", "repair", "weld_tolerance"}. Also throws "mesh.too_large", and the error of a stop request.
MeshUpload parse_mesh_arrays(std::string_view body, const Limits& limits, const surface::MeshLimits& mesh_limits,
                             const CancellationToken& cancellation);

}  // namespace supple::json
