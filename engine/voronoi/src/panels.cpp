#include "panels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>

#include "objectives.h"
#include "planar_cross.h"
#include "supple/base/file_text.h"
#include "supple/voronoi/export.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Gap between panels and maximum height of letters, in millimetres.
constexpr double panel_gap = 4;
constexpr double max_letter_height = 4;
/// Approximate ratio of a sheet's width to its height.
constexpr double sheet_ratio = 1.4;

/// A map from points to the Voronoi edges through them, to find the edge between two points of a cell's boundary.
class EdgesOfPoints {
 public:
  explicit EdgesOfPoints(const Diagram& diagram) {
    for (std::size_t e = 0; e < diagram.edges.size(); ++e)
      for (const std::int32_t point : diagram.edges[e].points) edges_[point].push_back(static_cast<std::int32_t>(e));
  }
  /// The edge of a site's cell that has both points; -1 if there is none.
  std::int32_t between(const Diagram& diagram, std::int32_t site, std::int32_t a, std::int32_t b) const {
    const auto of_a = edges_.find(a);
    const auto of_b = edges_.find(b);
    if (of_a == edges_.end() || of_b == edges_.end()) return -1;
    for (const std::int32_t edge : of_a->second) {
      const auto& sites = diagram.edges[static_cast<std::size_t>(edge)].sites;
      if (std::find(sites.begin(), sites.end(), site) == sites.end()) continue;
      if (std::find(of_b->second.begin(), of_b->second.end(), edge) != of_b->second.end()) return edge;
    }
    return -1;
  }
  /// The number of edges through a point.
  std::size_t count(std::int32_t point) const {
    const auto found = edges_.find(point);
    return found == edges_.end() ? 0 : found->second.size();
  }

 private:
  std::map<std::int32_t, std::vector<std::int32_t>> edges_;
};

}  // namespace

std::vector<Panel> panels(const Diagram& diagram) {
  const EdgesOfPoints edges(diagram);
  std::vector<Panel> result;
  for (std::size_t i = 0; i < diagram.cells.size(); ++i) {
    const DiagramCell& cell = diagram.cells[i];
    if (cell.boundary.size() != 1) continue;
    const std::vector<std::int32_t>& loop = cell.boundary.front();
    const auto site = static_cast<std::int32_t>(i);
    const auto next = [&](std::size_t k) { return loop[(k + 1) % loop.size()]; };
    const auto before = [&](std::size_t k) { return loop[(k + loop.size() - 1) % loop.size()]; };
    Panel panel;
    panel.site = site;
    std::vector<Vector3d> positions;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const std::int32_t after = edges.between(diagram, site, loop[k], next(k));
      if (after == edges.between(diagram, site, before(k), loop[k]) && after >= 0 &&
          diagram.points[static_cast<std::size_t>(loop[k])].kind != DiagramPoint::Kind::vertex)
        continue;  // within an edge, so not a corner
      positions.push_back(diagram.points[static_cast<std::size_t>(loop[k])].position);
      panel.edges.push_back(after);
      panel.neighbours.push_back(-1);
      panel.border_lengths.push_back(
          (diagram.points[static_cast<std::size_t>(next(k))].position - positions.back()).norm());
      if (after < 0) continue;
      const DiagramEdge& edge = diagram.edges[static_cast<std::size_t>(after)];
      panel.neighbours.back() = edge.sites[0] == site ? edge.sites[1] : edge.sites[0];
      panel.border_lengths.back() = edge.length;
    }
    if (positions.size() < 3) continue;
    FittedPlane plane = fit_plane(positions);
    double twice_area = 0;
    for (const Vector3d& position : positions) {
      const Vector3d offset = position - plane.centre;
      panel.corners.emplace_back(offset.dot(plane.first), offset.dot(plane.second));
    }
    for (std::size_t k = 0; k < panel.corners.size(); ++k)
      twice_area += cross(panel.corners[k], panel.corners[(k + 1) % panel.corners.size()]);
    if (twice_area < 0)
      for (Vector2d& corner : panel.corners) corner.y() = -corner.y();
    const double outwards = plane.first.cross(plane.second).dot(plane.normal) * twice_area < 0 ? -1 : 1;
    for (Eigen::Index k = 0; k < plane.distances.size(); ++k) panel.deviations.push_back(outwards * plane.distances[k]);
    result.push_back(std::move(panel));
  }
  return result;
}

namespace {

/// A sheet of panels in rows from the top left, the highest first. The longest edge of each panel is horizontal.
class Sheet {
 public:
  Sheet(std::vector<Panel> panels, double scale) : panels_(std::move(panels)) {
    for (Panel& panel : panels_) {
      for (Vector2d& corner : panel.corners) corner *= scale;
      rotate_to_longest_edge(panel);
    }
    std::stable_sort(panels_.begin(), panels_.end(),
                     [](const Panel& a, const Panel& b) { return extent(a).y() > extent(b).y(); });
    double area = 0;
    double widest = 0;
    for (const Panel& panel : panels_) {
      const Vector2d size = extent(panel);
      area += (size.x() + panel_gap) * (size.y() + panel_gap);
      widest = std::max(widest, size.x());
    }
    width_ = std::max(widest + 2 * panel_gap, std::sqrt(sheet_ratio * area));
    place_panels();
  }

  std::string draw() {
    svg_.precision(6);
    svg_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << width_ << ' ' << height_ << "\" width=\""
         << width_ << "mm\" height=\"" << height_ << "mm\" font-family=\"sans-serif\" text-anchor=\"middle\">\n";
    for (const Panel& panel : panels_) draw(panel);
    svg_ << "</svg>\n";
    return svg_.str();
  }

 private:
  static Vector2d extent(const Panel& panel) {
    Vector2d max_corner = panel.corners.front();
    for (const Vector2d& corner : panel.corners) max_corner = max_corner.cwiseMax(corner);
    return max_corner;
  }

  /// Rotates the panel so that its longest edge is horizontal, and moves it to the origin.
  static void rotate_to_longest_edge(Panel& panel) {
    std::size_t longest = 0;
    const auto edge = [&](std::size_t k) -> Vector2d {
      return panel.corners[(k + 1) % panel.corners.size()] - panel.corners[k];
    };
    for (std::size_t k = 1; k < panel.corners.size(); ++k)
      if (edge(k).squaredNorm() > edge(longest).squaredNorm()) longest = k;
    const Vector2d along = edge(longest).normalized();
    Vector2d min_corner = Vector2d::Constant(std::numeric_limits<double>::infinity());
    for (Vector2d& corner : panel.corners) {
      // The second axis of SVG points down: the panel is mirrored, so that its outside is seen.
      corner = Vector2d(corner.dot(along), -cross(along, corner));
      min_corner = min_corner.cwiseMin(corner);
    }
    for (Vector2d& corner : panel.corners) corner -= min_corner;
  }

  void place_panels() {
    Vector2d at(panel_gap, panel_gap);
    double row_height = 0;
    for (Panel& panel : panels_) {
      const Vector2d size = extent(panel);
      if (at.x() > panel_gap && at.x() + size.x() + panel_gap > width_) {
        at = Vector2d(panel_gap, at.y() + row_height + panel_gap);
        row_height = 0;
      }
      for (Vector2d& corner : panel.corners) corner += at;
      row_height = std::max(row_height, size.y());
      at.x() += size.x() + panel_gap;
    }
    height_ = at.y() + row_height + panel_gap;
  }

  void draw(const Panel& panel) {
    Vector2d centre = Vector2d::Zero();
    double shortest = std::numeric_limits<double>::infinity();
    svg_ << "<path fill=\"none\" stroke=\"#000000\" stroke-width=\"0.2\" d=\"";
    for (std::size_t k = 0; k < panel.corners.size(); ++k) {
      svg_ << (k == 0 ? 'M' : 'L') << panel.corners[k].x() << ' ' << panel.corners[k].y();
      centre += panel.corners[k] / static_cast<double>(panel.corners.size());
    }
    svg_ << "Z\"/>\n";
    for (const Vector2d& corner : panel.corners) shortest = std::min(shortest, (corner - centre).norm());
    const double letter = std::min(max_letter_height, 0.4 * shortest);
    text(centre, letter, "#b03030", panel.site);
    for (std::size_t k = 0; k < panel.corners.size(); ++k) {
      if (panel.edges[k] < 0) continue;
      const Vector2d middle = 0.5 * (panel.corners[k] + panel.corners[(k + 1) % panel.corners.size()]);
      text(middle + 0.25 * (centre - middle), 0.5 * letter, "#3a6ea5", panel.edges[k]);
    }
  }

  void text(const Vector2d& at, double size, const char* colour, std::int32_t number) {
    svg_ << "<text x=\"" << at.x() << "\" y=\"" << at.y() + 0.35 * size << "\" font-size=\"" << size << "\" fill=\""
         << colour << "\">" << number << "</text>\n";
  }

  std::vector<Panel> panels_;
  double width_ = 0;
  double height_ = 0;
  std::ostringstream svg_;
};

}  // namespace

std::string write_panels_svg(const Diagram& diagram, double scale) { return Sheet(panels(diagram), scale).draw(); }

std::string write_panels_csv(const Diagram& diagram) {
  FileText out;
  out << "panel,edge,neighbour,length,border_length,angle_degrees,deviation\n";
  for (const Panel& panel : panels(diagram)) {
    const std::size_t count = panel.corners.size();
    for (std::size_t k = 0; k < count; ++k) {
      const Vector2d to_next = panel.corners[(k + 1) % count] - panel.corners[k];
      const Vector2d to_last = panel.corners[(k + count - 1) % count] - panel.corners[k];
      double angle = std::atan2(cross(to_next, to_last), to_next.dot(to_last)) * 180 / std::numbers::pi;
      if (angle < 0) angle += 360;
      out.number(panel.site, ',');
      // An edge on the mesh's boundary has neither a number nor a neighbour.
      if (panel.edges[k] < 0)
        out << ",,";
      else
        out.number(panel.edges[k], ',').number(panel.neighbours[k], ',');
      out.number(to_next.norm(), ',').number(panel.border_lengths[k], ',').number(angle, ',');
      out.number(panel.deviations[k], '\n');
    }
  }
  return out.take();
}

}  // namespace supple::voronoi
