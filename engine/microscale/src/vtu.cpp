#include "supple/microscale/vtu.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "material_law.h"
#include "supple/base/file_text.h"
#include "supple/microscale/part_strain.h"

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

/// Quadratic triangles whose points have moved.
struct MovedGrid {
  const std::vector<std::array<int, 6>>& triangles;
  const Eigen::Matrix2Xd& rest;  ///< positions of the points, mm
  const Eigen::Matrix2Xd& moved;
};

void write_cells(FileText& out, const std::vector<std::array<int, 6>>& triangles) {
  out << "<Cells>\n";
  out.open_array("Int32", "connectivity");
  for (const auto& triangle : triangles) {
    for (const int point : triangle) out.number(point);
  }
  out.close_array().open_array("Int32", "offsets");
  for (std::size_t t = 1; t <= triangles.size(); ++t) out.number(6 * t);
  out.close_array().open_array("UInt8", "types");
  for (std::size_t t = 0; t < triangles.size(); ++t) out.number(vtk_quadratic_triangle);
  out.close_array() << "</Cells>\n";
}

/// `strains` has one entry for each triangle, or is empty if the file has none.
std::string write_grid(const MovedGrid& grid, const Material& material, const std::vector<double>& strains) {
  const MaterialLaw law(material);
  FileText out;
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n";
  out << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" << std::to_string(grid.rest.cols()) << "\" NumberOfCells=\""
      << std::to_string(grid.triangles.size()) << "\">\n";
  out << "<PointData Vectors=\"displacement\">\n";
  out.open_array("Float64", "displacement", 3);
  for (Eigen::Index i = 0; i < grid.rest.cols(); ++i) out.point(Eigen::Vector2d(grid.moved.col(i) - grid.rest.col(i)));
  out.close_array() << "</PointData>\n<CellData Scalars=\"energy_density\">\n";
  out.open_array("Float64", "energy_density");
  for (const auto& triangle : grid.triangles) {
    out.number(mean_energy_density(law, grid.rest(Eigen::all, triangle), grid.moved(Eigen::all, triangle)));
  }
  out.close_array();
  if (!strains.empty()) out.array("Float64", "largest_strain", strains, [](double strain) { return strain; });
  out << "</CellData>\n<Points>\n";
  out.open_array("Float64", "Points", 3);
  for (Eigen::Index i = 0; i < grid.rest.cols(); ++i) out.point(grid.rest.col(i));
  out.close_array() << "</Points>\n";
  write_cells(out, grid.triangles);
  out << "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return out.take();
}

}  // namespace

std::string write_vtu(const UnwrappedMesh& unwrapped, const DeformedMesh& deformed, const Material& material) {
  const Eigen::Matrix2Xd rest = positions(unwrapped, deformed.mesh->lattice, deformed.mesh->nodes);
  const Eigen::Matrix2Xd moved = positions(unwrapped, deformed.lattice, deformed.nodes);
  return write_grid({unwrapped.triangles, rest, moved}, material, {});
}

std::string write_part_vtu(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2Xd& displacements,
                           const Material& material) {
  const Eigen::Matrix2Xd moved = mesh.nodes + displacements;
  return write_grid({mesh.triangles, mesh.nodes, moved}, material, triangle_strains(mesh, displacements));
}

}  // namespace supple::microscale
