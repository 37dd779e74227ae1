#include "supple/weave/export.h"

#include "supple/base/file_text.h"

namespace supple::weave {
namespace {

constexpr int vtk_poly_line = 4;

}  // namespace

std::string write_obj(const std::vector<std::vector<Eigen::Vector3d>>& strands) {
  FileText out;
  for (const auto& strand : strands)
    for (const Eigen::Vector3d& point : strand) (out << "v ").point(point);
  std::size_t next = 1;
  for (const auto& strand : strands) {
    out << "l ";
    for (std::size_t i = 0; i < strand.size(); ++i) out.number(next++, i + 1 == strand.size() ? '\n' : ' ');
  }
  return out.take();
}

std::string write_vtu(const Weave& weave, const std::vector<std::vector<Eigen::Vector3d>>& strands) {
  std::size_t points = 0;
  for (const auto& strand : strands) points += strand.size();
  FileText out;
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n";
  (out << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"").number(points, '"') << " NumberOfCells=\"";
  out.number(strands.size(), '"') << ">\n<CellData Scalars=\"radius\">\n";
  out.open_array("Int32", "strand");
  for (std::size_t s = 0; s < strands.size(); ++s) out.number(s);
  out.close_array().open_array("Float64", "radius");
  for (std::size_t s = 0; s < strands.size(); ++s) out.number(weave.strands[s].radius);
  out.close_array() << "</CellData>\n<Points>\n";
  out.open_array("Float64", "Points", 3);
  for (const auto& strand : strands)
    for (const Eigen::Vector3d& point : strand) out.point(point);
  out.close_array() << "</Points>\n<Cells>\n";
  out.open_array("Int32", "connectivity");
  for (std::size_t i = 0; i < points; ++i) out.number(i);
  out.close_array().open_array("Int32", "offsets");
  std::size_t end = 0;
  for (const auto& strand : strands) out.number(end += strand.size());
  out.close_array().open_array("UInt8", "types");
  for (std::size_t s = 0; s < strands.size(); ++s) out.number(vtk_poly_line);
  out.close_array() << "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return out.take();
}

}  // namespace supple::weave
