#include "part_codec.h"

#include "structure_codec.h"

namespace supple::tiling {
namespace {

/// Stands for the smallest neck of a part that has none.
constexpr double no_neck = -1;

void write_polygons(ByteWriter& writer, const std::vector<Polygon>& polygons) {
  writer.list(polygons, [&writer](const Polygon& polygon) {
    writer.list(polygon, [&writer](const Eigen::Vector2d& p) { writer.matrix(p); });
  });
}

std::vector<Polygon> read_polygon_list(ByteReader& reader) {
  std::vector<Polygon> polygons;
  reader.list(polygons, [&reader] {
    Polygon polygon;
    reader.list(polygon, [&reader] {
      Eigen::Vector2d p;
      reader.matrix(p);
      return p;
    });
    return polygon;
  });
  return polygons;
}

void write_filling(ByteWriter& writer, const Filling& filling) {
  write(writer, filling.structure);
  writer.number(filling.beam_width).number(filling.orientation);
}

Filling read_filling(ByteReader& reader) {
  Filling filling;
  filling.structure = read_structure(reader);
  filling.beam_width = reader.number<double>();
  filling.orientation = reader.number<double>();
  return filling;
}

}  // namespace

void write(ByteWriter& writer, const PartDesign& design) {
  write_polygons(writer, design.outline);
  write_filling(writer, design.filling);
  writer.list(design.regions, [&writer](const PartRegion& region) {
    write_polygons(writer, {region.outline});
    write_filling(writer, region.filling);
    writer.text(region.name);
  });
  write_polygons(writer, design.solids);
  writer.number(design.outline_of_regions)
      .number(design.frame)
      .number(design.seam)
      .number(design.rim)
      .number(design.smallest_wall)
      .number(design.thickness)
      .number(design.divides_solid);
}

PartDesign read_part_design(ByteReader& reader) {
  PartDesign design;
  design.outline = read_polygon_list(reader);
  design.filling = read_filling(reader);
  reader.list(design.regions, [&reader] {
    PartRegion region;
    region.outline = read_polygon_list(reader).at(0);
    region.filling = read_filling(reader);
    region.name = reader.text();
    return region;
  });
  design.solids = read_polygon_list(reader);
  design.outline_of_regions = reader.number<bool>();
  design.frame = reader.number<double>();
  design.seam = reader.number<double>();
  design.rim = reader.number<Rim>();
  design.smallest_wall = reader.number<double>();
  design.thickness = reader.number<double>();
  design.divides_solid = reader.number<bool>();
  return design;
}

void write(ByteWriter& writer, const std::vector<SolidFace>& faces) {
  writer.list(faces, [&writer](const SolidFace& face) { write_polygons(writer, face); });
}

std::vector<SolidFace> read_faces(ByteReader& reader) {
  std::vector<SolidFace> faces;
  reader.list(faces, [&reader] { return read_polygon_list(reader); });
  return faces;
}

void write(ByteWriter& writer, const Part& part) {
  write(writer, part.faces);
  writer.matrix(part.lower).matrix(part.upper);
  writer.number(part.outline_area).number(part.solid_area).number(part.trimmed_area).size(part.crumbs);
  writer.number(part.crumb_area).number(part.thickness);
  writer.size(part.widened_necks)
      .size(part.cut_necks)
      .size(part.left_necks)
      .number(part.smallest_neck.value_or(no_neck));
  writer.list(part.lost_solids, [&writer](std::size_t solid) { writer.size(solid); });
  writer.list(part.regions, [&writer](const RegionSolid& region) {
    writer.text(region.name);
    write(writer, region.faces);
  });
}

Part read_part(ByteReader& reader) {
  Part part;
  part.faces = read_faces(reader);
  reader.matrix(part.lower);
  reader.matrix(part.upper);
  part.outline_area = reader.number<double>();
  part.solid_area = reader.number<double>();
  part.trimmed_area = reader.number<double>();
  part.crumbs = static_cast<std::size_t>(reader.number<std::uint64_t>());
  part.crumb_area = reader.number<double>();
  part.thickness = reader.number<double>();
  part.widened_necks = static_cast<std::size_t>(reader.number<std::uint64_t>());
  part.cut_necks = static_cast<std::size_t>(reader.number<std::uint64_t>());
  part.left_necks = static_cast<std::size_t>(reader.number<std::uint64_t>());
  if (const double width = reader.number<double>(); width != no_neck) part.smallest_neck = width;
  reader.list(part.lost_solids, [&reader] { return static_cast<std::size_t>(reader.number<std::uint64_t>()); });
  reader.list(part.regions, [&reader] {
    RegionSolid region;
    region.name = reader.text();
    region.faces = read_faces(reader);
    return region;
  });
  return part;
}

void write(ByteWriter& writer, const meshing::PlanarMesh& mesh) {
  writer.list(mesh.points, [&writer](const Eigen::Vector2d& p) { writer.matrix(p); });
  writer.list(mesh.triangles, [&writer](const std::array<int, 3>& triangle) {
    for (const int corner : triangle) writer.number(corner);
  });
}

meshing::PlanarMesh read_planar_mesh(ByteReader& reader) {
  meshing::PlanarMesh mesh;
  reader.list(mesh.points, [&reader] {
    Eigen::Vector2d p;
    reader.matrix(p);
    return p;
  });
  reader.list(mesh.triangles, [&reader] {
    std::array<int, 3> triangle{};
    for (int& corner : triangle) corner = reader.number<int>();
    return triangle;
  });
  return mesh;
}

}  // namespace supple::tiling
