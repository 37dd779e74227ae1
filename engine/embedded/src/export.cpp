#include "supple/embedded/export.h"

#include <array>

#include "supple/base/file_text.h"

namespace supple::embedded {
namespace {

constexpr int vtk_poly_line = 4;
constexpr int vtk_triangle = 5;
constexpr int vtk_tetrahedron = 10;

using Polyline = std::vector<Eigen::Vector3d>;

/// A polyline of at least two points for each spring.
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

/// The positions of the network's points if it has triangles, else none.
Polyline corner_positions(const surface::TriangleMesh& mesh, const Network& network, const Relaxation& relaxation) {
  Polyline corners;
  if (network.triangles.empty()) return corners;
  for (const auto& point : relaxation.points) corners.push_back(surface::position(mesh, point));
  return corners;
}

}  // namespace

std::string write_obj(const surface::TriangleMesh& mesh, const Network& network, const Relaxation& relaxation) {
  const auto lines = spring_lines(mesh, network, relaxation);
  FileText out;
  if (!relaxation.host.vertices.empty()) out << "o network\n";
  std::size_t next = 1;
  for (const auto& line : lines)
    for (const auto& point : line) (out << "v ").point(point);
  for (const auto& point : corner_positions(mesh, network, relaxation)) (out << "v ").point(point);
  for (const auto& line : lines) {
    out << "l ";
    for (std::size_t i = 0; i < line.size(); ++i) out.number(next++, i + 1 == line.size() ? '\n' : ' ');
  }
  for (const auto& triangle : network.triangles) {
    out << "f ";
    for (std::size_t k = 0; k < 3; ++k)
      out.number(next + static_cast<std::size_t>(triangle.corners[k]), k == 2 ? '\n' : ' ');
  }
  if (!relaxation.host.vertices.empty()) {
    if (!network.triangles.empty()) next += relaxation.points.size();
    out << "o host\n";
    for (const auto& vertex : relaxation.host.vertices) (out << "v ").point(vertex);
    for (const auto& face : mesh.faces()) {
      out << "f ";
      for (std::size_t k = 0; k < 3; ++k) out.number(next + static_cast<std::size_t>(face[k]), k == 2 ? '\n' : ' ');
    }
  }
  return out.take();
}

namespace {

/// A cell of a VTU: a spring, a triangle, or a face or tetrahedron of the host.
struct Cell {
  int type = vtk_poly_line;
  std::vector<std::size_t> points;
  Spring spring{0, 0, 0, 0};
  SpringState state{};
  std::array<double, 2> stretches{};
  bool is_host = false;
};

}  // namespace

namespace {

/// Adds the host's nodes and its tetrahedra; a shell has no tetrahedra, and its faces are added instead.
void add_host(const surface::TriangleMesh& mesh, const HostState& host, Polyline& points, std::vector<Cell>& cells) {
  const std::size_t first = points.size();
  points.insert(points.end(), host.vertices.begin(), host.vertices.end());
  points.insert(points.end(), host.inside.begin(), host.inside.end());
  const auto add = [&](int type, const auto& nodes) {
    auto& cell = cells.emplace_back();
    cell.type = type;
    cell.is_host = true;
    for (const std::int32_t node : nodes) cell.points.push_back(first + static_cast<std::size_t>(node));
  };
  for (const auto& tetrahedron : host.tetrahedra) add(vtk_tetrahedron, tetrahedron);
  if (!host.tetrahedra.empty() || host.vertices.empty()) return;
  for (const auto& face : mesh.faces()) add(vtk_triangle, face);
}

}  // namespace

std::string write_vtu(const surface::TriangleMesh& mesh, const Network& network, const Relaxation& relaxation) {
  const auto lines = spring_lines(mesh, network, relaxation);
  Polyline points;
  std::vector<Cell> cells;
  cells.reserve(lines.size() + network.triangles.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    auto& cell = cells.emplace_back();
    cell.spring = network.springs[i];
    cell.state = relaxation.springs[i];
    for (std::size_t k = 0; k < lines[i].size(); ++k) cell.points.push_back(points.size() + k);
    points.insert(points.end(), lines[i].begin(), lines[i].end());
  }
  const std::size_t first = points.size();
  const auto corners = corner_positions(mesh, network, relaxation);
  points.insert(points.end(), corners.begin(), corners.end());
  for (std::size_t t = 0; t < network.triangles.size(); ++t) {
    auto& cell = cells.emplace_back();
    cell.type = vtk_triangle;
    for (const std::int32_t corner : network.triangles[t].corners)
      cell.points.push_back(first + static_cast<std::size_t>(corner));
    cell.state.energy = relaxation.triangles[t].energy;
    cell.stretches = relaxation.triangles[t].stretches;
  }
  add_host(mesh, relaxation.host, points, cells);
  FileText out;
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n";
  (out << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"").number(points.size(), '"') << " NumberOfCells=\"";
  out.number(cells.size(), '"') << ">\n<CellData Scalars=\"energy\">\n";
  out.array("Float64", "length", cells, [](const Cell& cell) { return cell.state.length; })
      .array("Float64", "energy", cells, [](const Cell& cell) { return cell.state.energy; })
      .array("Float64", "rest_length", cells, [](const Cell& cell) { return cell.spring.rest_length; })
      .array("Float64", "weight", cells, [](const Cell& cell) { return cell.spring.weight; })
      .array("UInt8", "compressed", cells, [](const Cell& cell) { return cell.state.compressed ? 1 : 0; })
      .array("UInt8", "at_cut_locus", cells, [](const Cell& cell) { return cell.state.at_cut_locus ? 1 : 0; });
  if (!network.triangles.empty())
    out.array("Float64", "greater_stretch", cells, [](const Cell& cell) { return cell.stretches[0]; })
        .array("Float64", "lesser_stretch", cells, [](const Cell& cell) { return cell.stretches[1]; });
  if (!relaxation.host.vertices.empty())
    out.array("UInt8", "host", cells, [](const Cell& cell) { return cell.is_host ? 1 : 0; });
  out << "</CellData>\n<Points>\n"
      << "<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  for (const auto& point : points) out.point(point);
  out << "</DataArray>\n</Points>\n<Cells>\n";
  out.open_array("Int64", "connectivity");
  for (const Cell& cell : cells)
    for (const std::size_t point : cell.points) out.number(point);
  out.close_array();
  std::size_t end = 0;
  out.array("Int64", "offsets", cells, [&](const Cell& cell) { return end += cell.points.size(); })
      .array("UInt8", "types", cells, [](const Cell& cell) { return cell.type; });
  out << "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return out.take();
}

}  // namespace supple::embedded
