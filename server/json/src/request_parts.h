#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "fields.h"
#include "supple/json/limits.h"

// What several requests have in common.
namespace supple::json {

inline constexpr auto switch_names =
    names_of<Switch>({{Switch::automatic, "automatic"}, {Switch::on, "on"}, {Switch::off, "off"}});
inline constexpr auto priority_name_table =
    names_of<Priority>({{Priority::interactive, priority_name(Priority::interactive)},
                        {Priority::normal, priority_name(Priority::normal)},
                        {Priority::background, priority_name(Priority::background)}});

/// The ranges of lengths, of factors of energies, of angles, and of strains and other plain numbers. Meshes are 1e-70
/// to 1e70 mesh units wide: in these ranges, squares of their energies do not overflow.
inline constexpr double min_length = 1e-100;
inline constexpr double max_length = 1e100;
inline constexpr double min_factor = 1e-30;
inline constexpr double max_factor = 1e30;
inline constexpr double max_angle = 1000;
inline constexpr double max_dimensionless = 1e6;
inline constexpr int max_index = std::numeric_limits<int>::max();

/// The stretches that a load may have.
inline constexpr double min_stretch = 0.2;
inline constexpr double max_stretch = 4;

/// The field "deadline" in seconds, or its default. Throws "request.limit_exceeded".
double read_deadline(Fields& fields, const Limits& limits);

/// Checks the field "priority", whose value `peek_priority` reads.
void check_priority(Fields& fields);

/// Reads a request, of which read(fields, request) reads all fields but the deadline and the priority. Throws what
/// requests.h says.
template <class Request, class Read>
Request read_request(std::string_view body, const Limits& limits, const CancellationToken& cancellation, Read read) {
  const auto document = parse_document(body, limits, cancellation);
  Faults faults(cancellation);
  Fields fields(document, "", faults);
  Request request;
  read(fields, request);
  request.deadline = read_deadline(fields, limits);
  check_priority(fields);
  fields.finish();
  faults.throw_if_any();
  return request;
}

/// Whether the field holds an object, which stands in place of an array and says how to make one.
bool is_builder(Fields& fields, std::string_view name);

/// An optional array of indices of points or vertices. Its limit is that of points.
void read_indices(Fields& fields, std::string_view name, const Limits& limits, std::vector<std::int32_t>& indices);

/// Widths of beams that requests may ask for, in mm.
inline constexpr double min_beam_width = 0.01;
inline constexpr double max_beam_width = 100;

/// The fields "family" and "parameters".
struct StructureSpec;
StructureSpec read_structure(Fields& fields, const Limits& limits);

/// Calls read(fields) for an optional nested object.
template <class Read>
void nested(Fields& fields, std::string_view name, Read read) {
  const auto* value = fields.optional(name);
  if (!value) return;
  Fields inner(*value, fields.at(name), fields.faults());
  read(inner);
  inner.finish();
}

/// Reads as many numbers as `state` has components, each in [min, max].
template <class Vector>
bool read_components(const Document& entry, const std::string& pointer, Faults& faults, Vector& state, double min,
                     double max) {
  constexpr int count = Vector::RowsAtCompileTime;
  if (!entry.is_array() || entry.size() != count) {
    faults.add(pointer, "must be an array of " + std::to_string(count) + " numbers");
    return false;
  }
  bool good = true;
  for (int k = 0; k < count; ++k) {
    good &=
        read_number(entry[static_cast<std::size_t>(k)], pointer + "/" + std::to_string(k), faults, state[k], min, max);
  }
  return good;
}

}  // namespace supple::json
