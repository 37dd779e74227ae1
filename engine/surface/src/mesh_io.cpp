#include "supple/surface/mesh_io.h"

#include <bit>
#include <charconv>
#include <utility>

#include "mesh_reading.h"
#include "supple/base/durable_file.h"
#include "supple/base/error.h"
#include "supple/base/stop_pace.h"

namespace supple::surface {
namespace {

/// Whether the first line that is neither blank nor a comment begins with the keyword of an OFF file.
bool begins_with_off_keyword(std::string_view bytes) {
  TextScanner scanner(without_byte_order_mark(bytes));
  while (scanner.next_line()) {
    scanner.cut_comment();
    const std::string_view word = scanner.token();
    // A word such as 4OFF counts too, because read_off then explains that other dimensions are not read.
    if (!word.empty()) return (word.size() <= 8 && word.ends_with("OFF")) || read_off_keyword(word);
  }
  return false;
}

void append_number(std::string& text, double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  text.append(buffer, end);
}

template <typename Unsigned>
void append_little_endian(std::string& bytes, Unsigned value) {
  for (std::size_t i = 0; i < sizeof value; ++i) bytes += static_cast<char>(value >> 8 * i & 0xff);
}

}  // namespace

MeshFormat detect_format(std::string_view bytes) {
  const std::string_view text = without_byte_order_mark(bytes);
  if (text.starts_with("ply\n") || text.starts_with("ply\r")) return MeshFormat::ply;
  if (is_binary_stl(bytes)) return MeshFormat::stl;
  if (begins_with_solid(bytes)) return MeshFormat::stl;
  return begins_with_off_keyword(bytes) ? MeshFormat::off : MeshFormat::obj;
}

TriangleSoup read_mesh(std::string_view bytes, MeshFormat format, const MeshLimits& limits,
                       const Execution& execution) {
  if (!is_binary_stl(bytes)) refuse_foreign_files(bytes);
  switch (format) {
    case MeshFormat::off:
      return read_off(bytes, limits, execution);
    case MeshFormat::ply:
      return read_ply(bytes, limits, execution);
    case MeshFormat::stl:
      return read_stl(bytes, limits, execution);
    default:
      return read_obj(bytes, limits, execution);
  }
}

TriangleMesh load_mesh(std::string_view bytes, const MeshLimits& limits, const Execution& execution) {
  TriangleSoup soup = read_mesh(bytes, detect_format(bytes), limits, execution);
  return TriangleMesh::build(std::move(soup.positions), std::move(soup.faces), std::move(soup.warnings), execution);
}

TriangleMesh load_mesh_file(const std::filesystem::path& path, const MeshLimits& limits, const Execution& execution) {
  return load_mesh(content_of(path), limits, execution);
}

std::string write_obj(const TriangleMesh& mesh, const Execution& execution) {
  StopPace pace(execution.cancellation);
  std::string text;
  for (const Eigen::Vector3d& p : mesh.positions()) {
    pace.check();
    text += 'v';
    for (int i = 0; i < 3; ++i) {
      text += ' ';
      append_number(text, p[i]);
    }
    text += '\n';
  }
  for (const Triangle& face : mesh.faces()) {
    pace.check();
    text += 'f';
    for (const std::int32_t v : face) text += ' ' + std::to_string(v + 1);
    text += '\n';
  }
  return text;
}

std::string write_ply(const TriangleMesh& mesh, const Execution& execution) {
  StopPace pace(execution.cancellation);
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\n"
      "element vertex " +
      std::to_string(mesh.vertex_count()) +
      "\nproperty double x\nproperty double y\nproperty double z\n"
      "element face " +
      std::to_string(mesh.face_count()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  bytes.reserve(bytes.size() + 24 * mesh.positions().size() + 13 * mesh.faces().size());
  for (const Eigen::Vector3d& p : mesh.positions()) {
    pace.check();
    for (int i = 0; i < 3; ++i) append_little_endian(bytes, std::bit_cast<std::uint64_t>(p[i]));
  }
  for (const Triangle& face : mesh.faces()) {
    pace.check();
    bytes += '\3';
    for (const std::int32_t v : face) append_little_endian(bytes, static_cast<std::uint32_t>(v));
  }
  return bytes;
}

}  // namespace supple::surface
