#include "supple/microscale/vtu.h"

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "material_law.h"
#include "supple/base/file_text.h"

namespace supple::microscale {
namespace {

constexpr int vtk_quadratic_triangle = 22;

/// Elastic energy per rest area for the deformation gradient `f`, MPa. It is zero at rest.
double energy_density(const MaterialLaw& law, const Eigen::Matrix2d& f) {
  const double j = f.determinant();
  const double trace = f.squaredNorm();
  if (law.law == Law::incompressible_plane_stress) return law.mu / 2 * (trace + 1 / (j * j) - 3);
  const double log_j = std::log(j);
  return law.mu / 2 * (trace - 2 - 2 * log_j) + law.lambda / 2 * log_j * log_j;
}

/// Mean energy density of a quadratic triangle with straight sides at rest, MPa. Columns of `rest` and `deformed` are
/// positions of the corners and of the midpoints of the sides 01, 12, 20.
double mean_energy_density(const MaterialLaw& law, const Eigen::Matrix<double, 2, 6>& rest,
                           const Eigen::Matrix<double, 2, 6>& deformed) {
  Eigen::Matrix2d sides;
  sides << rest.col(1) - rest.col(0), rest.col(2) - rest.col(0);
  Eigen::Matrix<double, 3, 2> gradient;  // gradients of the barycentric coordinates, one in each row
  gradient.bottomRows<2>() = sides.inverse();
  gradient.row(0) = -gradient.row(1) - gradient.row(2);
  double sum = 0;
  for (int point = 0; point < 3; ++point) {
    Eigen::Vector3d l = Eigen::Vector3d::Constant(1.0 / 6);
    l[point] = 2.0 / 3;
    Eigen::Matrix2d f = Eigen::Matrix2d::Zero();
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      f += deformed.col(k) * (4 * l[k] - 1) * gradient.row(k);
      f += deformed.col(3 + k) * 4 * (l[k] * gradient.row(next) + l[next] * gradient.row(k));
    }
    sum += energy_density(law, f) / 3;
  }
  return sum;
}

void write_cells(FileText& out, const UnwrappedMesh& mesh) {
  out << "<Cells>\n";
  out.open_array("Int32", "connectivity");
  for (const auto& triangle : mesh.triangles) {
    for (const int point : triangle) out.number(point);
  }
  out.close_array().open_array("Int32", "offsets");
  for (std::size_t t = 1; t <= mesh.triangles.size(); ++t) out.number(6 * t);
  out.close_array().open_array("UInt8", "types");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) out.number(vtk_quadratic_triangle);
  out.close_array() << "</Cells>\n";
}

}  // namespace

std::string write_vtu(const UnwrappedMesh& unwrapped, const DeformedMesh& deformed, const Material& material) {
  const Eigen::Matrix2Xd rest = positions(unwrapped, deformed.mesh->lattice, deformed.mesh->nodes);
  const Eigen::Matrix2Xd moved = positions(unwrapped, deformed.lattice, deformed.nodes);
  const MaterialLaw law(material);
  FileText out;
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n";
  out << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" << std::to_string(rest.cols()) << "\" NumberOfCells=\""
      << std::to_string(unwrapped.triangles.size()) << "\">\n";
  out << "<PointData Vectors=\"displacement\">\n";
  out.open_array("Float64", "displacement", 3);
  for (Eigen::Index i = 0; i < rest.cols(); ++i) out.point(Eigen::Vector2d(moved.col(i) - rest.col(i)));
  out.close_array() << "</PointData>\n<CellData Scalars=\"energy_density\">\n";
  out.open_array("Float64", "energy_density");
  for (const auto& triangle : unwrapped.triangles) {
    out.number(mean_energy_density(law, rest(Eigen::all, triangle), moved(Eigen::all, triangle)));
  }
  out.close_array() << "</CellData>\n<Points>\n";
  out.open_array("Float64", "Points", 3);
  for (Eigen::Index i = 0; i < rest.cols(); ++i) out.point(rest.col(i));
  out.close_array() << "</Points>\n";
  write_cells(out, unwrapped);
  out << "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return out.take();
}

}  // namespace supple::microscale
