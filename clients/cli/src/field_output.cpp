#include "field_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <string_view>

#include "color_map.h"
#include "failure.h"

namespace supple::cli {
namespace {

static_assert(std::endian::native == std::endian::little,
              "fields and PLY files are written in the machine's byte order");

constexpr std::array<std::uint8_t, 3> unreachable_color = {128, 128, 128};
constexpr double dark_band = 0.8;  // factor on the colours of every second band

template <class Value>
void append(std::string& bytes, const Value& value) {
  const std::size_t size = bytes.size();
  bytes.resize(size + sizeof(Value));
  std::memcpy(bytes.data() + size, &value, sizeof(Value));
}

/// The number after `key` in a PLY header; 0 if it is missing.
std::size_t count_of(std::string_view header, std::string_view key) {
  const std::size_t at = header.find(key);
  std::size_t count = 0;
  if (at != std::string_view::npos) {
    std::from_chars(header.data() + at + key.size(), header.data() + header.size(), count);
  }
  return count;
}

std::array<std::uint8_t, 3> banded_color(double fraction, int bands) {
  auto color = color_of(fraction);
  if (bands > 0 && static_cast<int>(std::floor(fraction * bands)) % 2 == 1) {
    for (auto& channel : color) channel = static_cast<std::uint8_t>(dark_band * channel);
  }
  return color;
}

}  // namespace

std::vector<double> decode_field(const std::string& bytes) {
  if (bytes.size() % sizeof(double) != 0) {
    throw Failure(ExitCode::server_error,
                  fmt::format("the field has {} bytes, which is no multiple of {}", bytes.size(), sizeof(double)));
  }
  std::vector<double> values(bytes.size() / sizeof(double));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  for (double& value : values) {
    if (value < 0) value = std::numeric_limits<double>::infinity();
  }
  return values;
}

Geometry decode_geometry(const std::string& ply) {
  constexpr std::string_view end_of_header = "end_header\n";
  const std::size_t header_end = ply.find(end_of_header);
  const std::string_view header = std::string_view(ply).substr(0, header_end);
  const auto vertices = count_of(header, "element vertex ");
  const auto faces = count_of(header, "element face ");
  constexpr std::size_t vertex_size = 3 * sizeof(double);
  constexpr std::size_t face_size = 1 + 3 * sizeof(std::int32_t);
  const std::size_t body = header_end + end_of_header.size();
  if (header_end == std::string::npos || ply.size() != body + vertices * vertex_size + faces * face_size) {
    throw Failure(ExitCode::server_error, "the server's mesh file is not in the form that this version reads");
  }
  Geometry geometry;
  geometry.positions.resize(vertices);
  geometry.faces.resize(faces);
  std::memcpy(geometry.positions.data(), ply.data() + body, vertices * vertex_size);
  const char* next = ply.data() + body + vertices * vertex_size;
  for (auto& face : geometry.faces) {
    std::memcpy(face.data(), next + 1, sizeof(face));  // the first byte is the length of the list, 3
    next += face_size;
  }
  return geometry;
}

std::string field_as_csv(const std::vector<double>& distances) {
  std::string text = "vertex,distance\n";
  auto out = std::back_inserter(text);
  for (std::size_t v = 0; v < distances.size(); ++v) {
    if (std::isfinite(distances[v])) {
      fmt::format_to(out, "{},{}\n", v, distances[v]);
    } else {
      fmt::format_to(out, "{},\n", v);
    }
  }
  return text;
}

std::string field_as_ply(const Geometry& mesh, const std::vector<double>& distances, int bands) {
  double largest = 0;
  for (const double d : distances) {
    if (std::isfinite(d)) largest = std::max(largest, d);
  }
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment geodesic distances; infinite where unreachable\n"
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nproperty double quality\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      mesh.positions.size(), mesh.faces.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double d = v < distances.size() ? distances[v] : std::numeric_limits<double>::infinity();
    append(bytes, mesh.positions[v]);
    append(bytes, std::isfinite(d) ? banded_color(largest > 0 ? d / largest : 0, bands) : unreachable_color);
    append(bytes, d);
  }
  for (const auto& face : mesh.faces) {
    append(bytes, std::uint8_t{3});
    append(bytes, face);
  }
  return bytes;
}

}  // namespace supple::cli
