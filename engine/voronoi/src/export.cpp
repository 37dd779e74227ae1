#include "supple/voronoi/export.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include "supple/base/file_text.h"

namespace supple::voronoi {
namespace {

constexpr int vtk_poly_line = 4;
constexpr int vtk_polygon = 7;

/// The surface cut along the borders: each cell's whole faces and its pieces of cut faces. Corners of pieces are points
/// of their own.
struct CutSurface {
  struct Polygon {
    std::int32_t site = -1;
    std::vector<std::size_t> corners;
  };
  std::vector<Eigen::Vector3d> points;
  std::vector<Polygon> polygons;  ///< ascending by site; -1 for faces that no path from a site reaches
};

CutSurface cut_surface(const surface::TriangleMesh& mesh, const Diagram& diagram) {
  CutSurface result;
  result.points = mesh.positions();
  std::vector<std::vector<CutSurface::Polygon>> of_sites(diagram.cells.size() + 1);
  const auto add = [&](std::int32_t site, std::vector<std::size_t> corners) {
    of_sites[static_cast<std::size_t>(site) + 1].push_back({site, std::move(corners)});
  };
  for (std::size_t face = 0; face < diagram.face_sites.size(); ++face) {
    if (diagram.face_sites[face] == -1) continue;
    const surface::Triangle& corners = mesh.faces()[face];
    add(std::max(-1, diagram.face_sites[face]), {corners.begin(), corners.end()});
  }
  for (const DiagramPiece& piece : diagram.pieces) {
    std::vector<std::size_t> corners;
    const Eigen::Vector3d* first = &diagram.corners[static_cast<std::size_t>(piece.first_corner)];
    for (std::int32_t k = 0; k < piece.corner_count; ++k) {
      corners.push_back(result.points.size());
      result.points.push_back(surface::position(mesh, {FaceId(piece.face), first[k]}));
    }
    add(piece.site, std::move(corners));
  }
  for (std::vector<CutSurface::Polygon>& polygons : of_sites)
    for (CutSurface::Polygon& polygon : polygons) result.polygons.push_back(std::move(polygon));
  return result;
}

}  // namespace

std::string write_obj(const surface::TriangleMesh& mesh, const Diagram& diagram) {
  FileText out;
  out << "o borders\n";
  for (const DiagramPoint& point : diagram.points) (out << "v ").point(point.position);
  for (const DiagramEdge& edge : diagram.edges) {
    out << "l ";
    for (std::size_t i = 0; i < edge.points.size(); ++i)
      out.number(edge.points[i] + 1, i + 1 == edge.points.size() ? '\n' : ' ');
  }
  const CutSurface cells = cut_surface(mesh, diagram);
  out << "o cells\n";
  for (const Eigen::Vector3d& point : cells.points) (out << "v ").point(point);
  std::int32_t site = -2;
  for (const CutSurface::Polygon& polygon : cells.polygons) {
    if (polygon.site != site) {
      site = polygon.site;
      if (site < 0)
        out << "g unreached\n";
      else
        (out << "g cell_").number(site, '\n');
    }
    out << "f ";
    for (std::size_t i = 0; i < polygon.corners.size(); ++i)
      out.number(diagram.points.size() + polygon.corners[i] + 1, i + 1 == polygon.corners.size() ? '\n' : ' ');
  }
  return out.take();
}

std::string write_vtu(const surface::TriangleMesh& mesh, const Diagram& diagram) {
  struct Cell {
    int type;
    std::int32_t site;
    double area;
    std::vector<std::size_t> points;
  };
  const CutSurface surface = cut_surface(mesh, diagram);
  std::vector<Cell> cells;
  for (const CutSurface::Polygon& polygon : surface.polygons) {
    const double area = polygon.site < 0 ? 0 : diagram.cells[static_cast<std::size_t>(polygon.site)].area;
    cells.push_back({vtk_polygon, polygon.site, area, polygon.corners});
  }
  for (const DiagramEdge& edge : diagram.edges) {
    Cell& line = cells.emplace_back(Cell{vtk_poly_line, -1, 0, {}});
    for (const std::int32_t point : edge.points)
      line.points.push_back(surface.points.size() + static_cast<std::size_t>(point));
  }
  FileText out;
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n";
  (out << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"").number(surface.points.size() + diagram.points.size(), '"')
      << " NumberOfCells=\"";
  out.number(cells.size(), '"') << ">\n<CellData Scalars=\"site\">\n";
  out.array("Int32", "site", cells, [](const Cell& cell) { return cell.site; })
      .array("Float64", "area", cells, [](const Cell& cell) { return cell.area; });
  out << "</CellData>\n<Points>\n"
      << "<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  for (const Eigen::Vector3d& point : surface.points) out.point(point);
  for (const DiagramPoint& point : diagram.points) out.point(point.position);
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

}  // namespace supple::voronoi
