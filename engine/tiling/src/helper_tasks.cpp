#include "supple/tiling/helper_tasks.h"

#include "file_makers.h"
#include "helper_run.h"
#include "part_tasks.h"
#include "structure_codec.h"

namespace supple::tiling {
namespace {

constexpr std::string_view mesh_task = "tiling/mesh";
constexpr std::string_view svg_task = "tiling/svg";
constexpr std::string_view dxf_task = "tiling/dxf";
constexpr std::string_view stl_task = "tiling/stl";

/// Patches up to this number of tiles are made in this process: the union of their beams takes some milliseconds, which
/// a stop request may wait.
constexpr double max_tiles_in_process = 64;

using Make = std::string (*)(const Structure&, const ExportOptions&);

bool is_small(const Structure& structure, const ExportOptions& options) {
  return static_cast<double>(options.first) * options.second *
             static_cast<double>(structure.tiling.placements.size()) <=
         max_tiles_in_process;
}

std::string write_file(std::string_view task, Make make, const Structure& structure, const ExportOptions& options,
                       const Execution& execution) {
  execution.cancellation.throw_if_requested();
  const auto helpers = helper_processes();
  if (!helpers) return make(structure, options);
  ByteWriter request;
  write(request, structure);
  write(request, options);
  return run_task(*helpers, task, request.take(), execution);
}

HelperTask file_task(Make make) {
  return [make](std::string_view request) {
    ByteReader reader(request);
    const Structure structure = read_structure(reader);
    return make(structure, read_export_options(reader));
  };
}

std::string mesh_of(std::string_view request) {
  ByteReader reader(request);
  const Structure structure = read_structure(reader);
  ByteWriter answer;
  write(answer, make_mesh(structure, read_mesh_options(reader)));
  return answer.take();
}

}  // namespace

std::string write_svg(const Structure& structure, const ExportOptions& options, const Execution& execution) {
  if (is_small(structure, options)) return make_svg(structure, options);
  return write_file(svg_task, make_svg, structure, options, execution);
}

std::string write_dxf(const Structure& structure, const ExportOptions& options, const Execution& execution) {
  if (is_small(structure, options)) return make_dxf(structure, options);
  return write_file(dxf_task, make_dxf, structure, options, execution);
}

std::string write_stl(const Structure& structure, const ExportOptions& options, const Execution& execution) {
  return write_file(stl_task, make_stl, structure, options, execution);
}

PeriodicMesh mesh_structure(const Structure& structure, const MeshOptions& options, const Execution& execution) {
  execution.cancellation.throw_if_requested();
  const auto helpers = helper_processes();
  if (!helpers) return make_mesh(structure, options);
  ByteWriter request;
  write(request, structure);
  write(request, options);
  const std::string answer = run_task(*helpers, mesh_task, request.take(), execution);
  ByteReader reader(answer);
  return read_mesh(reader);
}

HelperTasks helper_tasks() {
  HelperTasks tasks;
  tasks.emplace(mesh_task, mesh_of);
  tasks.emplace(svg_task, file_task(make_svg));
  tasks.emplace(dxf_task, file_task(make_dxf));
  tasks.emplace(stl_task, file_task(make_stl));
  add_part_tasks(tasks);
  add_part_mesh_task(tasks);
  return tasks;
}

}  // namespace supple::tiling
