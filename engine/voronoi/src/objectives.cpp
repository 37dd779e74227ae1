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

/// Of the mean cell size: no site moves farther in a step.
constexpr double longest_step = 0.5;

/// The derivatives of a few numbers by the sites that they depend on.
class SiteRows {
 public:
  explicit SiteRows(Eigen::Index rows) : rows_(rows) {}

  /// The two columns of a site, zero at first.
  Eigen::Block<MatrixXd> of(std::int32_t site) {
    const auto place = std::find(sites_.begin(), sites_.end(), site);
    const auto column = 2 * static_cast<Eigen::Index>(place - sites_.begin());
    if (place == sites_.end()) {
      sites_.push_back(site);
      if (column + 2 > matrix_.cols()) matrix_.conservativeResize(rows_, std::max<Eigen::Index>(16, 2 * column));
      matrix_.middleCols(column, 2).setZero();
    }
    return matrix_.block(0, column, rows_, 2);
  }

  /// Row `row` += scale * (coefficients . the vertex's coordinates).
  void add_vertex(Eigen::Index row, const VertexMotion& motion, const Vector2d& coefficients) {
    for (std::size_t k = 0; k < motion.pulls.size(); ++k)
      of(motion.pulls[k].site).row(row) += coefficients.dot(motion.along[k]) * motion.pulls[k].by_site.transpose();
  }

  Eigen::Block<MatrixXd> matrix() { return matrix_.block(0, 0, rows_, 2 * static_cast<Eigen::Index>(sites_.size())); }

  /// Adds the gradient and the Gauss-Newton Hessian of (scale / 2) |residuals|^2.
  void add_to(EnergySum& sum, int order, double scale, const VectorXd& residuals) {
    const auto jacobian = matrix();
    const VectorXd slope = scale * (jacobian.transpose() * residuals);
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
    sum.add_element(rows, order, 0, slope.data(), lower.data());
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
  return longest > 0 ? longest_step * unit_ / longest : std::numeric_limits<double>::infinity();
}

void EdgeLengthTerm::add(const SitesState& state, int order, EnergySum& sum) const {
  const Found& found = *state.found();
  const double scale = weight() / squared(unit());
  for (std::size_t i = 0; i < found.measured_edges.size(); ++i) {
    const surface::TangentGeodesic& geodesic = found.edge_lengths[i];
    const double residual = geodesic.distance - length_;
    sum.value += 0.5 * scale * squared(residual);
    if (order < 1) continue;
    const auto& [a, b] = found.diagram.edges[static_cast<std::size_t>(found.measured_edges[i])].vertices;
    SiteRows rows(1);
    rows.add_vertex(0, found.motions[static_cast<std::size_t>(a)], -geodesic.from_direction);
    rows.add_vertex(0, found.motions[static_cast<std::size_t>(b)], geodesic.to_direction);
    rows.add_to(sum, order, scale, VectorXd::Constant(1, residual));
  }
}

void EdgeLengthTerm::add_cell_energies(const SitesState& state, VectorXd& energies) const {
  const Found& found = *state.found();
  for (std::size_t i = 0; i < found.measured_edges.size(); ++i) {
    const double energy = 0.5 * weight() / squared(unit()) * squared(found.edge_lengths[i].distance - length_);
    for (const std::int32_t site : found.diagram.edges[static_cast<std::size_t>(found.measured_edges[i])].sites)
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
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (Eigen::Index j = 0; j < count; ++j) {
    const Vector3d offset = points[static_cast<std::size_t>(j)] - plane.centre;
    spread += w[j] * offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  plane.normal = axes.eigenvectors().col(0);
  plane.first = axes.eigenvectors().col(1);
  plane.second = axes.eigenvectors().col(2);
  plane.distances.resize(count);
  for (Eigen::Index j = 0; j < count; ++j)
    plane.distances[j] = plane.normal.dot(points[static_cast<std::size_t>(j)] - plane.centre);
  return plane;
}

namespace {

/// Of the vertices of a polygon: lengths of the sides that follow them, and what part of the perimeter is theirs.
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

/// A cell's vertices, and their distances from the plane that fits them best.
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
  VectorXd squares;  ///< of the distances
  double mean = 0;   ///< of the squares, by the perimeter's weights
};

/// Three points lie in a plane.
bool may_be_curved(const DiagramCell& cell) { return cell.vertices.size() > 3; }

}  // namespace

void PlanarityTerm::add_cell_energies(const SitesState& state, VectorXd& energies) const {
  const Diagram& diagram = state.found()->diagram;
  for (std::size_t i = 0; i < diagram.cells.size(); ++i)
    if (may_be_curved(diagram.cells[i]))
      energies[static_cast<Eigen::Index>(i)] +=
          0.5 * weight() / squared(unit()) * CellPlane(diagram, diagram.cells[i]).mean;
}

void PlanarityTerm::add(const SitesState& state, int order, EnergySum& sum) const {
  const Found& found = *state.found();
  const Diagram& diagram = found.diagram;
  const double scale = weight() / squared(unit());
  for (const DiagramCell& cell : diagram.cells) {
    if (!may_be_curved(cell)) continue;
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
    SiteRows rows(count);
    SiteRows of_weights(1);
    for (Eigen::Index j = 0; j < count; ++j) {
      const auto vertex = static_cast<std::size_t>(cell.vertices[static_cast<std::size_t>(j)]);
      const surface::SurfacePoint& at = diagram.points[static_cast<std::size_t>(diagram.vertices[vertex].point)].point;
      const Eigen::Matrix<double, 3, 2> frame = surface::tangent_frame(state.mesh(), at.face);
      rows.add_vertex(j, found.motions[vertex], roots[j] * frame.transpose() * plane.normal);
      // A side that grows gives its ends a larger part of the perimeter.
      Vector3d pull = Vector3d::Zero();
      for (const Eigen::Index side : {j, (j + count - 1) % count}) {
        if (!(perimeter.sides[side] > 0)) continue;
        const double worth = 0.5 * (squares[side] + squares[(side + 1) % count]) - mean;
        const Vector3d along = (position(side + 1) - position(side)) / perimeter.sides[side];
        pull += (side == j ? -1 : 1) * worth / perimeter.length * along;
      }
      of_weights.add_vertex(0, found.motions[vertex], frame.transpose() * pull);
    }
    of_weights.add_to(sum, 1, 0.5 * scale, VectorXd::Ones(1));
    if (order >= 2) {
      // The plane follows: what it can take up of the motion leaves the residuals as they are. They are orthogonal to
      // that, so that the gradient does not change.
      Eigen::MatrixX3d taken(count, 3);
      for (Eigen::Index j = 0; j < count; ++j) {
        const Vector3d offset = position(j) - plane.centre;
        taken.row(j) << roots[j], roots[j] * offset.dot(plane.first), roots[j] * offset.dot(plane.second);
      }
      taken.colwise().normalize();
      auto matrix = rows.matrix();
      matrix -= taken * (taken.transpose() * matrix).eval();
    }
    rows.add_to(sum, order, scale, roots.cwiseProduct(plane.distances));
  }
}

void RegularityTerm::add_cell_energies(const SitesState& state, VectorXd& energies) const {
  const Diagram& diagram = state.found()->diagram;
  for (const DiagramVertex& vertex : diagram.vertices) {
    const double distance = diagram.points[static_cast<std::size_t>(vertex.point)].distance;
    for (const std::int32_t site : vertex.sites) energies[site] += 0.5 * weight() / squared(unit()) * squared(distance);
  }
}

void RegularityTerm::add(const SitesState& state, int order, EnergySum& sum) const {
  const Found& found = *state.found();
  for (std::size_t v = 0; v < found.diagram.vertices.size(); ++v) {
    const DiagramVertex& vertex = found.diagram.vertices[v];
    const double distance = found.diagram.points[static_cast<std::size_t>(vertex.point)].distance;
    // The distances from all of its sites are and stay the same.
    const double scale = weight() * static_cast<double>(vertex.sites.size()) / squared(unit());
    sum.value += 0.5 * scale * squared(distance);
    if (order < 1) continue;
    const VertexMotion& motion = found.motions[v];
    SiteRows rows(1);
    rows.add_vertex(0, motion, motion.pulls[0].by_place);
    rows.of(motion.pulls[0].site).row(0) += motion.pulls[0].by_site.transpose();
    rows.add_to(sum, order, scale, VectorXd::Constant(1, distance));
  }
}

void CentroidalTerm::add_cell_energies(const SitesState& state, VectorXd& energies) const {
  const std::vector<CellMoments>& cells = state.found()->diagram.cell_moments;
  for (std::size_t i = 0; i < cells.size(); ++i)
    energies[static_cast<Eigen::Index>(i)] += 0.5 * weight() / squared(squared(unit())) * cells[i].squared_distance;
}

void CentroidalTerm::add(const SitesState& state, int order, EnergySum& sum) const {
  const Found& found = *state.found();
  const double scale = weight() / squared(squared(unit()));
  const std::vector<CellMoments>& cells = found.diagram.cell_moments;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    sum.value += 0.5 * scale * cells[i].squared_distance;
    if (order >= 1) sum.gradient.segment<2>(2 * static_cast<Eigen::Index>(i)) += scale * cells[i].pull;
  }
  if (order < 2) return;
  for (std::size_t i = 0; i < found.diagram.cells.size(); ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    for (int k = 0; k < 2; ++k) sum.hessian.add(row + k, row + k, scale * found.diagram.cells[i].area);
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
  const Diagram& diagram = state.found()->diagram;
  const double mean = mean_area(diagram);
  for (std::size_t i = 0; i < diagram.cells.size(); ++i)
    energies[static_cast<Eigen::Index>(i)] +=
        0.5 * weight() / squared(squared(unit())) * squared(diagram.cells[i].area - mean);
}

void EqualAreaTerm::add(const SitesState& state, int order, EnergySum& sum) const {
  const Found& found = *state.found();
  const Diagram& diagram = found.diagram;
  const double scale = weight() / squared(squared(unit()));
  const double mean = mean_area(diagram);
  for (const DiagramCell& cell : diagram.cells) sum.value += 0.5 * scale * squared(cell.area - mean);
  if (order < 1) return;
  std::vector<SiteRows> rows(diagram.cells.size(), SiteRows(1));
  for (const BorderSample& sample : diagram.border_samples) {
    const auto& [left, right] = sample.pulls;
    if (left.site < 0 || right.site < 0) continue;
    const double steepness = (left.by_place - right.by_place).norm();
    if (!(steepness > 0)) continue;
    // Towards the right the border moves by minus the change of the difference of the distances, over its slope.
    const double share = sample.weight / steepness;
    for (const double side : {1.0, -1.0}) {
      SiteRows& own = rows[static_cast<std::size_t>(side > 0 ? left.site : right.site)];
      own.of(left.site).row(0) -= side * share * left.by_site.transpose();
      own.of(right.site).row(0) += side * share * right.by_site.transpose();
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i].add_to(sum, order, scale, VectorXd::Constant(1, diagram.cells[i].area - mean));
}

}  // namespace supple::voronoi
