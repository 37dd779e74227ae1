#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "supple/json/answers.h"
#include "supple/json/json_writer.h"

// What several answers have in common.
namespace supple::json {

/// "effects" and "cost", which end every answer.
void write_bill(JsonWriter& out, const Bill& bill);

/// A point of a surface.
void write_point(JsonWriter& out, const surface::SurfacePoint& point);
/// The field "points_in_space", where the request has any.
void write_points_in_space(JsonWriter& out, std::span<const PlacedPoint> points);
/// A field with the places in space of points of a surface.
void write_positions(JsonWriter& out, std::string_view name, const surface::TriangleMesh& mesh,
                     std::span<const surface::SurfacePoint> points);
/// An array of indices.
void write_indices(JsonWriter& out, std::span<const std::int32_t> indices);
/// The field "warnings".
void write_warnings(JsonWriter& out, std::span<const std::string> warnings);
/// A path on a surface.
void write_path(JsonWriter& out, const std::vector<surface::PathPoint>& path);

/// A number that may be missing: null where it is not finite.
void write_number_or_null(JsonWriter& out, double value);
/// The same as the field of that name.
void write_number_or_null(JsonWriter& out, std::string_view name, double value);

/// A matrix as the array of its rows.
template <class Matrix>
void write_rows(JsonWriter& out, const Matrix& matrix) {
  out.begin_array();
  for (decltype(matrix.rows()) i = 0; i < matrix.rows(); ++i) out.numbers(matrix.row(i).transpose().eval());
  out.end_array();
}

/// The field "lattice": translations are columns in the engine and rows on the wire.
inline void write_lattice(JsonWriter& out, const Eigen::Matrix2d& lattice) {
  out.key("lattice");
  write_rows(out, lattice.transpose().eval());
}

}  // namespace supple::json
