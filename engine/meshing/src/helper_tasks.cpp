#include "supple/meshing/helper_tasks.h"

#include <stdexcept>

#include "fill_here.h"
#include "gmsh_owner.h"
#include "supple/base/byte_codec.h"

namespace supple::meshing {
namespace {

constexpr std::string_view fill_task = "meshing/fill";

template <std::size_t n>
void write_corners(ByteWriter& writer, const std::array<std::int32_t, n>& corners) {
  for (const std::int32_t corner : corners) writer.number(corner);
}

template <std::size_t n>
std::array<std::int32_t, n> read_corners(ByteReader& reader) {
  std::array<std::int32_t, n> corners{};
  for (std::int32_t& corner : corners) corner = reader.number<std::int32_t>();
  return corners;
}

Eigen::Vector3d read_position(ByteReader& reader) {
  Eigen::Vector3d position;
  reader.matrix(position);
  return position;
}

std::string filled(std::string_view request) {
  ByteReader reader(request);
  std::vector<Eigen::Vector3d> positions;
  reader.list(positions, [&reader] { return read_position(reader); });
  std::vector<SurfaceTriangle> faces;
  reader.list(faces, [&reader] { return read_corners<3>(reader); });
  FillOptions options;
  options.element_size = reader.number<double>();
  options.grading = reader.number<double>();
  options.max_tetrahedra = reader.number<std::int64_t>();
  const TetrahedralMesh mesh = fill_here(positions, faces, options, {});
  ByteWriter answer;
  answer.list(mesh.nodes, [&answer](const Eigen::Vector3d& node) { answer.matrix(node); });
  answer.list(mesh.tetrahedra, [&answer](const Tetrahedron& corners) { write_corners(answer, corners); });
  answer.number(mesh.surface_vertices);
  return answer.take();
}

}  // namespace

TetrahedralMesh fill(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces,
                     const FillOptions& options, const Execution& execution) {
  const auto helpers = helper_processes();
  if (!helpers) return fill_here(positions, faces, options, execution);
  // Options out of range are a mistake of the program, not of a request: they are reported in this process.
  if (!(options.element_size >= 0) || !(options.grading > 0) || options.max_tetrahedra < 1)
    throw std::invalid_argument("fill: element_size is 0 or more, grading and max_tetrahedra are positive");
  execution.checkpoint(0, "meshing");
  const StageTimer timer(execution.cost, "meshing");
  ByteWriter request;
  request.list(positions, [&request](const Eigen::Vector3d& position) { request.matrix(position); });
  request.list(faces, [&request](const SurfaceTriangle& corners) { write_corners(request, corners); });
  request.number(options.element_size).number(options.grading).number(options.max_tetrahedra);
  const std::string answer = helpers->run(fill_task, request.take(), execution);
  ByteReader reader(answer);
  TetrahedralMesh mesh;
  reader.list(mesh.nodes, [&reader] { return read_position(reader); });
  reader.list(mesh.tetrahedra, [&reader] { return read_corners<4>(reader); });
  mesh.surface_vertices = reader.number<std::int32_t>();
  execution.checkpoint(1, "meshing");
  return mesh;
}

HelperTasks helper_tasks() {
  HelperTasks tasks;
  tasks.emplace(fill_task, filled);
  return tasks;
}

void prepare_helper() { const GmshSession session; }

}  // namespace supple::meshing
