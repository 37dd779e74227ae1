#include "supple/embedded/export.h"

#include "supple/base/file_text.h"

namespace supple::embedded {
namespace {

constexpr int vtk_poly_line = 4;

using Polyline = std::vector<Eigen::Vector3d>;

/// A line for each spring, of at least two points.
std::vector<Polyline> spring_lines(const surface::TriangleMesh& mesh, const Network& network,
                                   const Relaxation& relaxation) {
  std::vector<Polyline> lines;
  lines.reserve(network.springs.size());
  const auto end = [&](std::int32_t point) {
    return surface::position(mesh, relaxation.points[static_cast<std::size_t>(point)]);
  };
  for (std::size_t i = 0; i < network.springs.size(); ++i) {
    auto& line = lines.emplace_back();
    for (const auto& point : relaxation.springs[i].path) line.push_back(point.position);
    if (line.size() < 2) line = {end(network.springs[i].from), end(network.springs[i].to)};
  }
  return lines;
}

}  // namespace

std::string write_obj(const surface::TriangleMesh& mesh, const Network& network, const Relaxation& relaxation) {
  const auto lines = spring_lines(mesh, network, relaxation);
  FileText out;
  for (const auto& line : lines)
    for (const auto& point : line) (out << "v ").point(point);
  std::size_t next = 1;
  for (const auto& line : lines) {
    out << "l ";
    for (std::size_t i = 0; i < line.size(); ++i) out.number(next++, i + 1 == line.size() ? '\n' : ' ');
  }
  return out.take();
}

std::string write_vtu(const surface::TriangleMesh& mesh, const Network& network, const Relaxation& relaxation) {
  const auto lines = spring_lines(mesh, network, relaxation);
  Polyline points;
  for (const auto& line : lines) points.insert(points.end(), line.begin(), line.end());
  FileText out;
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n";
  (out << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"").number(points.size(), '"') << " NumberOfCells=\"";
  out.number(lines.size(), '"') << ">\n<CellData Scalars=\"length\">\n";
  out.array("Float64", "length", relaxation.springs, [](const SpringState& spring) { return spring.length; })
      .array("Float64", "energy", relaxation.springs, [](const SpringState& spring) { return spring.energy; })
      .array("Float64", "rest_length", network.springs, [](const Spring& spring) { return spring.rest_length; })
      .array("Float64", "weight", network.springs, [](const Spring& spring) { return spring.weight; })
      .array("UInt8", "compressed", relaxation.springs, [](const SpringState& s) { return s.compressed ? 1 : 0; })
      .array("UInt8", "at_cut_locus", relaxation.springs, [](const SpringState& s) { return s.at_cut_locus ? 1 : 0; });
  out << "</CellData>\n<Points>\n"
      << "<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  for (const auto& point : points) out.point(point);
  out << "</DataArray>\n</Points>\n<Cells>\n";
  std::size_t next = 0;
  std::size_t end = 0;
  out.array("Int64", "connectivity", points, [&](const Eigen::Vector3d&) { return next++; })
      .array("Int64", "offsets", lines, [&](const Polyline& line) { return end += line.size(); })
      .array("UInt8", "types", lines, [](const Polyline&) { return vtk_poly_line; });
  out << "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return out.take();
}

}  // namespace supple::embedded
