// Feeds arbitrary bytes to the mesh readers, which must return a consistent mesh or throw an Error.

#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "supple/base/error.h"
#include "supple/surface/mesh_io.h"
#include "supple/surface/mesh_repair.h"
#include "supple/surface/mesh_report.h"

namespace {

using supple::surface::MeshFormat;
using supple::surface::MeshLimits;
using supple::surface::TriangleMesh;

constexpr MeshLimits limits{.vertices = 2000, .faces = 4000};

void require(bool condition) {
  if (!condition) std::abort();
}

/// Checks that the messages of an error are printable for any bytes, since users get them as JSON.
void check_error(const supple::Error& error) {
  require(!error.code().empty() && !error.details().empty());
  const auto printable = [](std::string_view text) {
    for (const char c : text) require(c >= ' ' && c <= '~');
  };
  printable(error.what());
  for (const auto& detail : error.details()) {
    printable(detail.where);
    printable(detail.message);
  }
}

void check_mesh(const TriangleMesh& mesh) {
  require(mesh.vertex_count() <= limits.vertices && mesh.face_count() <= limits.faces);
  for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h) {
    require(mesh.edge_length(h) > 0 && mesh.corner_angle(h) >= 0);
    require(mesh.twin(h) < 0 || (mesh.twin(mesh.twin(h)) == h && mesh.tail(mesh.twin(h)) == mesh.head(h)));
  }
  const supple::surface::MeshReport report = supple::surface::report(mesh);
  require(report.genus >= 0 && report.components >= 1 && report.area > 0);
  for (const std::string& warning : report.warnings) {
    for (const char c : warning) require(c >= ' ' && c <= '~');
  }
  const TriangleMesh again = supple::surface::load_mesh(supple::surface::write_ply(mesh), limits);
  require(again.faces() == mesh.faces() && again.positions() == mesh.positions());
}

/// Repairs the soup automatically. The resulting mesh must be valid, or the error must say that it cannot be repaired.
void check_repairs(supple::surface::TriangleSoup soup) {
  try {
    const auto outcome = supple::surface::repair_automatically(soup, limits);
    for (const std::int32_t f : outcome.new_faces) require(f < static_cast<std::int64_t>(soup.faces.size()));
    const TriangleMesh mesh = supple::surface::build_with_advice(std::move(soup), limits);
    for (const std::string& warning : supple::surface::crack_warnings(mesh))
      for (const char c : warning) require(c >= ' ' && c <= '~');
  } catch (const supple::Error& error) {
    check_error(error);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    check_mesh(supple::surface::load_mesh(bytes, limits));
  } catch (const supple::Error& error) {
    check_error(error);
  }
  for (const MeshFormat format : {MeshFormat::obj, MeshFormat::off, MeshFormat::ply, MeshFormat::stl}) {
    try {
      auto soup = supple::surface::read_mesh(bytes, format, limits);
      require(static_cast<std::int64_t>(soup.positions.size()) <= limits.vertices &&
              static_cast<std::int64_t>(soup.faces.size()) <= limits.faces);
      check_repairs(std::move(soup));
    } catch (const supple::Error& error) {
      check_error(error);
    }
  }
  return 0;
}
