#include "supple/weave/export.h"

#include <charconv>
#include <string_view>
#include <utility>

namespace supple::weave {
namespace {

constexpr int vtk_poly_line = 4;

class Text {
 public:
  Text& operator<<(std::string_view text) {
    text_ += text;
    return *this;
  }
  template <class Number>
  Text& number(Number value, char after = ' ') {
    char buffer[32];
    text_.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
    text_ += after;
    return *this;
  }
  Text& point(const Eigen::Vector3d& p) { return number(p[0]).number(p[1]).number(p[2], '\n'); }
  Text& open(std::string_view type, std::string_view name, int components = 1) {
    *this << "<DataArray type=\"" << type << "\" Name=\"" << name << "\" NumberOfComponents=\"";
    return number(components, '"') << " format=\"ascii\">\n";
  }
  Text& close() { return *this << "\n</DataArray>\n"; }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace

std::string write_obj(const std::vector<std::vector<Eigen::Vector3d>>& strands) {
  Text out;
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
  Text out;
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n";
  (out << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"").number(points, '"') << " NumberOfCells=\"";
  out.number(strands.size(), '"') << ">\n<CellData Scalars=\"radius\">\n";
  out.open("Int32", "strand");
  for (std::size_t s = 0; s < strands.size(); ++s) out.number(s);
  out.close().open("Float64", "radius");
  for (std::size_t s = 0; s < strands.size(); ++s) out.number(weave.strands[s].radius);
  out.close() << "</CellData>\n<Points>\n";
  out.open("Float64", "Points", 3);
  for (const auto& strand : strands)
    for (const Eigen::Vector3d& point : strand) out.point(point);
  out.close() << "</Points>\n<Cells>\n";
  out.open("Int32", "connectivity");
  for (std::size_t i = 0; i < points; ++i) out.number(i);
  out.close().open("Int32", "offsets");
  std::size_t end = 0;
  for (const auto& strand : strands) out.number(end += strand.size());
  out.close().open("UInt8", "types");
  for (std::size_t s = 0; s < strands.size(); ++s) out.number(vtk_poly_line);
  out.close() << "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return out.take();
}

}  // namespace supple::weave
