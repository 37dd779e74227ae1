#include "structure_codec.h"

namespace supple::tiling {
namespace {

void write(ByteWriter& writer, const Polygon& polygon) {
  writer.list(polygon, [&writer](const Eigen::Vector2d& p) { writer.matrix(p); });
}

Eigen::Vector2d read_point(ByteReader& reader) {
  Eigen::Vector2d point;
  reader.matrix(point);
  return point;
}

Polygon read_polygon(ByteReader& reader) {
  Polygon polygon;
  reader.list(polygon, [&reader] { return read_point(reader); });
  return polygon;
}

std::vector<Polygon> read_polygons(ByteReader& reader) {
  std::vector<Polygon> polygons;
  reader.list(polygons, [&reader] { return read_polygon(reader); });
  return polygons;
}

}  // namespace

void write(ByteWriter& writer, const Structure& structure) {
  writer.text(structure.family);
  writer.list(structure.parameters, [&writer](double value) { writer.number(value); });
  writer.number(structure.beam_width).number(structure.scale);
  writer.list(structure.tiling.tiles, [&writer](const Polygon& tile) { write(writer, tile); });
  writer.list(structure.tiling.placements, [&writer](const Placement& placement) {
    writer.number(placement.tile).matrix(placement.linear).matrix(placement.offset);
  });
  writer.matrix(structure.tiling.lattice);
  writer.list(structure.holes, [&writer](const std::vector<Polygon>& holes) {
    writer.list(holes, [&writer](const Polygon& hole) { write(writer, hole); });
  });
  writer.number(structure.tiles_cross).number(structure.cell_area).number(structure.solid_area);
}

Structure read_structure(ByteReader& reader) {
  Structure structure;
  structure.family = reader.text();
  reader.list(structure.parameters, [&reader] { return reader.number<double>(); });
  structure.beam_width = reader.number<double>();
  structure.scale = reader.number<double>();
  structure.tiling.tiles = read_polygons(reader);
  reader.list(structure.tiling.placements, [&reader] {
    Placement placement;
    placement.tile = reader.number<int>();
    reader.matrix(placement.linear);
    reader.matrix(placement.offset);
    return placement;
  });
  reader.matrix(structure.tiling.lattice);
  reader.list(structure.holes, [&reader] { return read_polygons(reader); });
  structure.tiles_cross = reader.number<bool>();
  structure.cell_area = reader.number<double>();
  structure.solid_area = reader.number<double>();
  return structure;
}

void write(ByteWriter& writer, const ExportOptions& options) {
  writer.number(options.first).number(options.second).number(options.height);
}

ExportOptions read_export_options(ByteReader& reader) {
  ExportOptions options;
  options.first = reader.number<int>();
  options.second = reader.number<int>();
  options.height = reader.number<double>();
  return options;
}

void write(ByteWriter& writer, const MeshOptions& options) {
  writer.number(options.mesh_size).number(options.corner_size).number(options.region).number(options.max_nodes);
}

MeshOptions read_mesh_options(ByteReader& reader) {
  MeshOptions options;
  options.mesh_size = reader.number<double>();
  options.corner_size = reader.number<double>();
  options.region = reader.number<Region>();
  options.max_nodes = reader.number<int>();
  return options;
}

void write(ByteWriter& writer, const PeriodicMesh& mesh) {
  writer.matrix(mesh.lattice).size(static_cast<std::size_t>(mesh.nodes.cols())).matrix(mesh.nodes);
  writer.list(mesh.triangles, [&writer](const std::array<int, 6>& triangle) {
    for (const int node : triangle) writer.number(node);
  });
  writer.list(mesh.shifts, [&writer](const std::array<LatticeShift, 6>& shifts) {
    for (const LatticeShift& shift : shifts) writer.number(shift.first).number(shift.second);
  });
  writer.list(mesh.outline,
              [&writer](const PeriodicMesh::Side& side) { writer.number(side.triangle).number(side.side); });
  writer.number(mesh.cells_first).number(mesh.cells_second).number(mesh.mesh_size).number(mesh.beam_width);
}

PeriodicMesh read_mesh(ByteReader& reader) {
  PeriodicMesh mesh;
  reader.matrix(mesh.lattice);
  mesh.nodes.resize(2, static_cast<Eigen::Index>(reader.size()));
  reader.matrix(mesh.nodes);
  reader.list(mesh.triangles, [&reader] {
    std::array<int, 6> triangle{};
    for (int& node : triangle) node = reader.number<int>();
    return triangle;
  });
  reader.list(mesh.shifts, [&reader] {
    std::array<LatticeShift, 6> shifts;
    for (LatticeShift& shift : shifts) {
      shift.first = reader.number<std::int8_t>();
      shift.second = reader.number<std::int8_t>();
    }
    return shifts;
  });
  reader.list(mesh.outline, [&reader] {
    PeriodicMesh::Side side;
    side.triangle = reader.number<int>();
    side.side = reader.number<int>();
    return side;
  });
  mesh.cells_first = reader.number<int>();
  mesh.cells_second = reader.number<int>();
  mesh.mesh_size = reader.number<double>();
  mesh.beam_width = reader.number<double>();
  return mesh;
}

}  // namespace supple::tiling
