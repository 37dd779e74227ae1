#include "objectives.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace supple::voronoi {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using numerics::EnergySum;

/// Relative to the mean cell size: maximum displacement of a site in one step.
constexpr double max_site_step = 0.5;

/// The Jacobian of a few quantities by the coordinates of the sites that they depend on.
class SiteJacobian {
 public:
  explicit SiteJacobian(Eigen::Index rows) : rows_(rows) {}

  /// The two columns of a site, which are zero at first.
  Eigen::Block<MatrixXd> columns_of(std::int32_t site) {
    const auto place = std::find(sites_.begin(), sites_.end(), site);
    const auto column = 2 * static_cast<Eigen::Index>(place - sites_.begin());
    if (place == sites_.end()) {
      sites_.push_back(site);
      if (column + 2 > matrix_.cols()) matrix_.conservativeResize(rows_, std::max<Eigen::Index>(16, 2 * column));
      matrix_.middleCols(column, 2).setZero();
    }
    return matrix_.block(0, column, rows_, 2);
  }

  /// Adds the derivative of `coefficients` . (tangent coordinates of a Voronoi vertex) to a row.
  void add_vertex(Eigen::Index row, const VertexMotion& motion, const Vector2d& coefficients) {
    for (std::size_t k = 0; k < motion.gradients.size(); ++k)
      columns_of(motion.gradients[k].site).row(row) +=
          coefficients.dot(motion.directions[k]) * motion.gradients[k].by_site.transpose();
  }

  Eigen::Block<MatrixXd> matrix() { return matrix_.block(0, 0, rows_, 2 * static_cast<Eigen::Index>(sites_.size())); }

  /// Adds the gradient and the Gauss-Newton Hessian of (scale / 2) |residuals|^2.
  void add_to(EnergySum& sum, int order, double scale, const VectorXd& residuals) {
    const auto jacobian = matrix();
    const VectorXd gradient = scale * (jacobian.transpose() * residuals);
    std::vector<std::int32_t> rows;
    for (const std::int32_t site : sites_) {
      rows.push_back(2 * site);
      rows.push_back(2 * site + 1);
    }
    std::vector<double> lower;
    if (order >= 2) {
      const MatrixXd hessian = scale * (jacobian.transpose() * jacobian);
      for (Eigen::Index k = 0; k < hessian.rows(); ++k)
        for (Eigen::Index l = 0; l <= k; ++l) lower.push_back(hessian(k, l));
    }
    sum.add_element(rows, order, 0, gradient.data(), lower.data());
  }

 private:
  Eigen::Index rows_;
  std::vector<std::int32_t> sites_;
  MatrixXd matrix_;
};

double squared(double x) { return x * x; }

}  // namespace

double DiagramTerm::largest_step(const SitesState& /*state*/, const VectorXd& step) const {
  double longest = 0;
  for (Eigen::Index i = 0; i + 1 < step.size(); i += 2) longest = std::max(longest, step.segment<2>(i).norm());
  return longest > 0 ? max_site_step * unit_ / longest : std::numeric_limits<double>::infinity();
}

void EdgeLengthTerm::add(const SitesState& state, int order, EnergySum& sum) const {
  const DiagramEvaluation& evaluation = *state.evaluation();
  const double scale = weight() / squared(unit());
  for (std::size_t i = 0; i < evaluation.measured_edges.size(); ++i) {
    const surface::TangentGeodesic& geodesic = evaluation.edge_lengths[i];
    const double residual = geodesic.distance - length_;
    sum.value += 0.5 * scale * squared(residual);
    if (order < 1) continue;
    const auto& [a, b] = evaluation.diagram.edges[static_cast<std::size_t>(evaluation.measured_edges[i])].vertices;
    SiteJacobian rows(1);
    rows.add_vertex(0, evaluation.motions[static_cast<std::size_t>(a)], -geodesic.from_direction);
    rows.add_vertex(0, evaluation.motions[static_cast<std::size_t>(b)], geodesic.to_direction);
    rows.add_to(sum, order, scale, VectorXd::Constant(1, residual));
  }
}

void EdgeLengthTerm::add_cell_energies(const SitesState& state, VectorXd& energies) const {
  const DiagramEvaluation& evaluation = *state.evaluation();
  for (std::size_t i = 0; i < evaluation.measured_edges.size(); ++i) {
    const double energy = 0.5 * weight() / squared(unit()) * squared(evaluation.edge_lengths[i].distance - length_);
    for (const std::int32_t site :
         evaluation.diagram.edges[static_cast<std::size_t>(evaluation.measured_edges[i])].sites)
      energies[site] += 0.5 * energy;
  }
}

std::vector<Vector3d> vertex_positions(const Diagram& diagram, const DiagramCell& cell) {
  std::vector<Vector3d> positions;
  for (const std::int32_t vertex : cell.vertices)
    positions.push_back(
        diagram.points[static_cast<std::size_t>(diagram.vertices[static_cast<std::size_t>(vertex)].point)].position);
  return positions;
}

FittedPlane fit_plane(const std::vector<Vector3d>& points, const VectorXd& weights) {
  const auto count = static_cast<Eigen::Index>(points.size());
  const VectorXd w = weights.size() > 0 ? weights : VectorXd::Constant(count, 1.0 / static_cast<double>(count));
  FittedPlane plane;
  for (Eigen::Index j = 0; j < count; ++j) plane.centre += w[j] * points[static_cast<std::size_t>(j)];
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (Eigen::Index j = 0; j < count; ++j) {
    const Vector3d offset = points[static_cast<std::size_t>(j)] - plane.centre;
    covariance += w[j] * offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  plane.normal = axes.eigenvectors().col(0);
  plane.first = axes.eigenvectors().col(1);
  plane.second = axes.eigenvectors().col(2);
  plane.distances.resize(count);
  for (Eigen::Index j = 0; j < count; ++j)
    plane.distances[j] = plane.normal.dot(points[static_cast<std::size_t>(j)] - plane.centre);
  return plane;
}

namespace {

/// Lengths of the sides that follow the corners of a polygon, and weights of the corners as fractions of the perimeter.
struct Perimeter {
  explicit Perimeter(const std::vector<Vector3d>& corners) {
    const auto count = static_cast<Eigen::Index>(corners.size());
    sides.resize(count);
    weights.resize(count);
    for (Eigen::Index j = 0; j < count; ++j)
      sides[j] = (corners[static_cast<std::size_t>((j + 1) % count)] - corners[static_cast<std::size_t>(j)]).norm();
    length = sides.sum();
    for (Eigen::Index j = 0; j < count; ++j) weights[j] = 0.5 * (sides[j] + sides[(j + count - 1) % count]) / length;
  }
  VectorXd sides;
  VectorXd weights;
  double length = 0;
};

/// A cell's vertices, and the plane that fits them best.
struct CellPlane {
  CellPlane(const Diagram& diagram, const DiagramCell& cell)
      : positions(vertex_positions(diagram, cell)), perimeter(positions) {
    if (!(perimeter.length > 0)) return;
    plane = fit_plane(positions, perimeter.weights);
    squares = plane.distances.array().square();
    mean = perimeter.weights.dot(squares);
  }
  std::vector<Vector3d> positions;
  Perimeter perimeter;
  FittedPlane plane;
  VectorXd squares;  ///< squared distances from the plane
  double mean = 0;   ///< their mean, with the perimeter's weights
};

/// Cells of three vertices or fewer are planar.
bool can_be_nonplanar(const DiagramCell& cell) { return cell.vertices.size() > 3; }

}  // namespace

void PlanarityTerm::add_cell_energies(const SitesState& state, VectorXd& energies) const {
  const Diagram& diagram = state.evaluation()->diagram;
  for (std::size_t i = 0; i < diagram.cells.size(); ++i)
    if (can_be_nonplanar(diagram.cells[i]))
      energies[static_cast<Eigen::Index>(i)] +=
          0.5 * weight() / squared(unit()) * CellPlane(diagram, diagram.cells[i]).mean;
}

void PlanarityTerm::add(const SitesState& state, int order, EnergySum& sum) const {
  const DiagramEvaluation& evaluation = *state.evaluation();
  const Diagram& diagram = evaluation.diagram;
  const double scale = weight() / squared(unit());
  for (const DiagramCell& cell : diagram.cells) {
    if (!can_be_nonplanar(cell)) continue;
    const auto count = static_cast<Eigen::Index>(cell.vertices.size());
    const CellPlane fitted(diagram, cell);
    const std::vector<Vector3d>& positions = fitted.positions;
    const Perimeter& perimeter = fitted.perimeter;
    const FittedPlane& plane = fitted.plane;
    const VectorXd& squares = fitted.squares;
    const double mean = fitted.mean;
    if (!(perimeter.length > 0)) continue;
    sum.value += 0.5 * scale * mean;
    if (order < 1) continue;
    const auto position = [&](Eigen::Index j) -> const Vector3d& {
      return positions[static_cast<std::size_t>((j + count) % count)];
    };
    const VectorXd roots = perimeter.weights.array().sqrt();
    SiteJacobian rows(count);
    SiteJacobian weight_row(1);
    for (Eigen::Index j = 0; j < count; ++j) {
      const auto vertex = static_cast<std::size_t>(cell.vertices[static_cast<std::size_t>(j)]);
      const surface::SurfacePoint& at = diagram.points[static_cast<std::size_t>(diagram.vertices[vertex].point)].point;
      const Eigen::Matrix<double, 3, 2> frame = surface::tangent_frame(state.mesh(), at.face);
      rows.add_vertex(j, evaluation.motions[vertex], roots[j] * frame.transpose() * plane.normal);
      // A longer side increases the weights of its two ends.
      Vector3d position_gradient = Vector3d::Zero();
      for (const Eigen::Index side : {j, (j + count - 1) % count}) {
        if (!(perimeter.sides[side] > 0)) continue;
        const double weight_derivative = 0.5 * (squares[side] + squares[(side + 1) % count]) - mean;
        const Vector3d along = (position(side + 1) - position(side)) / perimeter.sides[side];
        position_gradient += (side == j ? -1 : 1) * weight_derivative / perimeter.length * along;
      }
      weight_row.add_vertex(0, evaluation.motions[vertex], frame.transpose() * position_gradient);
    }
    weight_row.add_to(sum, 1, 0.5 * scale, VectorXd::Ones(1));
    if (order >= 2) {
      // The plane follows the vertices: motions that it can follow do not change the residuals. These are orthogonal to
      // such motions, so that the gradient stays the same.
      Eigen::MatrixX3d plane_motions(count, 3);
      for (Eigen::Index j = 0; j < count; ++j) {
        const Vector3d offset = position(j) - plane.centre;
        plane_motions.row(j) << roots[j], roots[j] * offset.dot(plane.first), roots[j] * offset.dot(plane.second);
      }
      plane_motions.colwise().normalize();
      auto matrix = rows.matrix();
      matrix -= plane_motions * (plane_motions.transpose() * matrix).eval();
    }
    rows.add_to(sum, order, scale, roots.cwiseProduct(plane.distances));
  }
}

void RegularityTerm::add_cell_energies(const SitesState& state, VectorXd& energies) const {
  const Diagram& diagram = state.evaluation()->diagram;
  for (const DiagramVertex& vertex : diagram.vertices) {
    const double distance = diagram.points[static_cast<std::size_t>(vertex.point)].distance;
    for (const std::int32_t site : vertex.sites) energies[site] += 0.5 * weight() / squared(unit()) * squared(distance);
  }
}

void RegularityTerm::add(const SitesState& state, int order, EnergySum& sum) const {
  const DiagramEvaluation& evaluation = *state.evaluation();
  for (std::size_t v = 0; v < evaluation.diagram.vertices.size(); ++v) {
    const DiagramVertex& vertex = evaluation.diagram.vertices[v];
    const double distance = evaluation.diagram.points[static_cast<std::size_t>(vertex.point)].distance;
    // The vertex stays equally far from all of its sites.
    const double scale = weight() * static_cast<double>(vertex.sites.size()) / squared(unit());
    sum.value += 0.5 * scale * squared(distance);
    if (order < 1) continue;
    const VertexMotion& motion = evaluation.motions[v];
    SiteJacobian rows(1);
    rows.add_vertex(0, motion, motion.gradients[0].by_place);
    rows.columns_of(motion.gradients[0].site).row(0) += motion.gradients[0].by_site.transpose();
    rows.add_to(sum, order, scale, VectorXd::Constant(1, distance));
  }
}

void CentroidalTerm::add_cell_energies(const SitesState& state, VectorXd& energies) const {
  const std::vector<CellMoments>& cells = state.evaluation()->diagram.cell_moments;
  for (std::size_t i = 0; i < cells.size(); ++i)
    energies[static_cast<Eigen::Index>(i)] += 0.5 * weight() / squared(squared(unit())) * cells[i].squared_distance;
}

void CentroidalTerm::add(const SitesState& state, int order, EnergySum& sum) const {
  const DiagramEvaluation& evaluation = *state.evaluation();
  const double scale = weight() / squared(squared(unit()));
  const std::vector<CellMoments>& cells = evaluation.diagram.cell_moments;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    sum.value += 0.5 * scale * cells[i].squared_distance;
    if (order >= 1) sum.gradient.segment<2>(2 * static_cast<Eigen::Index>(i)) += scale * cells[i].gradient;
  }
  if (order < 2) return;
  for (std::size_t i = 0; i < evaluation.diagram.cells.size(); ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    for (int k = 0; k < 2; ++k) sum.hessian.add(row + k, row + k, scale * evaluation.diagram.cells[i].area);
  }
}

namespace {

double mean_area(const Diagram& diagram) {
  double total = 0;
  for (const DiagramCell& cell : diagram.cells) total += cell.area;
  return total / static_cast<double>(diagram.cells.size());
}

}  // namespace

void EqualAreaTerm::add_cell_energies(const SitesState& state, VectorXd& energies) const {
  const Diagram& diagram = state.evaluation()->diagram;
  const double mean = mean_area(diagram);
  for (std::size_t i = 0; i < diagram.cells.size(); ++i)
    energies[static_cast<Eigen::Index>(i)] +=
        0.5 * weight() / squared(squared(unit())) * squared(diagram.cells[i].area - mean);
}

void EqualAreaTerm::add(const SitesState& state, int order, EnergySum& sum) const {
  const DiagramEvaluation& evaluation = *state.evaluation();
  const Diagram& diagram = evaluation.diagram;
  const double scale = weight() / squared(squared(unit()));
  const double mean = mean_area(diagram);
  for (const DiagramCell& cell : diagram.cells) sum.value += 0.5 * scale * squared(cell.area - mean);
  if (order < 1) return;
  std::vector<SiteJacobian> rows(diagram.cells.size(), SiteJacobian(1));
  for (const BorderSample& sample : diagram.border_samples) {
    const auto& [left, right] = sample.gradients;
    if (left.site < 0 || right.site < 0) continue;
    const double gap_gradient = (left.by_place - right.by_place).norm();
    if (!(gap_gradient > 0)) continue;
    // The border moves towards the right by minus the change of the difference of the distances, divided by the norm of
    // its gradient.
    const double factor = sample.weight / gap_gradient;
    for (const double side : {1.0, -1.0}) {
      SiteJacobian& own = rows[static_cast<std::size_t>(side > 0 ? left.site : right.site)];
      own.columns_of(left.site).row(0) -= side * factor * left.by_site.transpose();
      own.columns_of(right.site).row(0) += side * factor * right.by_site.transpose();
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i].add_to(sum, order, scale, VectorXd::Constant(1, diagram.cells[i].area - mean));
}

}  // namespace supple::voronoi
