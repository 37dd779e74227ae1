#include "contact_outline.h"

#include <utility>

#include "cell_coordinates.h"
#include "contact_geometry.h"
#include "contact_search.h"

namespace supple::microscale {
namespace {

Eigen::Vector2i cell(const tiling::LatticeShift& shift) { return {shift.first, shift.second}; }

/// Sets Segment::next at the points where exactly one segment ends and exactly one begins.
void link(ContactOutline& outline) {
  struct Junction {
    int arriving = 0;  ///< segments that end at the point
    int leaving = 0;   ///< segments that begin there
    int next = -1;     ///< a segment that begins there
  };
  std::vector<Junction> junctions(outline.nodes.size());
  for (std::size_t s = 0; s < outline.segments.size(); ++s) {
    Junction& tail = junctions[static_cast<std::size_t>(outline.segments[s].tail)];
    ++tail.leaving;
    tail.next = static_cast<int>(s);
    ++junctions[static_cast<std::size_t>(outline.segments[s].head)].arriving;
  }
  for (ContactOutline::Segment& segment : outline.segments) {
    const Junction& head = junctions[static_cast<std::size_t>(segment.head)];
    if (head.arriving == 1 && head.leaving == 1) segment.next = head.next;
  }
}

}  // namespace

ContactOutline::ContactOutline(const tiling::PeriodicMesh& mesh) : lattice(mesh.lattice) {
  std::vector<int> point_of(static_cast<std::size_t>(mesh.nodes.cols()), -1);
  const auto point = [&](int node) {
    int& index = point_of[static_cast<std::size_t>(node)];
    if (index < 0) {
      index = points();
      nodes.push_back(node);
    }
    return index;
  };
  for (const auto& [triangle, side] : mesh.outline) {
    const auto& corners = mesh.triangles[static_cast<std::size_t>(triangle)];
    const auto& shifts = mesh.shifts[static_cast<std::size_t>(triangle)];
    const auto first = static_cast<std::size_t>(side);
    const std::size_t middle = first + 3;
    const std::size_t last = (first + 1) % 3;
    for (const auto& [from, to] : {std::pair(first, middle), std::pair(middle, last)}) {
      const int tail = point(corners[from]);
      const int head = point(corners[to]);
      segments.push_back({tail, head, cell(shifts[to]) - cell(shifts[from]), -1});
    }
  }
  rest.resize(2, points());
  for (int p = 0; p < points(); ++p) rest.col(p) = mesh.nodes.col(nodes[static_cast<std::size_t>(p)]);
  lengths.assign(nodes.size(), 0.0);
  const Eigen::Vector2i here = Eigen::Vector2i::Zero();
  for (const Segment& segment : segments) {
    const double half = (rest_head(segment, here) - rest_tail(segment, here)).norm() / 2;
    lengths[static_cast<std::size_t>(segment.tail)] += half;
    lengths[static_cast<std::size_t>(segment.head)] += half;
  }
  link(*this);
}

Eigen::Vector2d ContactOutline::rest_tail(const Segment& segment, const Eigen::Vector2i& shift) const {
  return rest.col(segment.tail) + lattice * shift.cast<double>();
}

Eigen::Vector2d ContactOutline::rest_head(const Segment& segment, const Eigen::Vector2i& shift) const {
  return rest.col(segment.head) + lattice * (shift + segment.head_shift).cast<double>();
}

void gather_displacements(const ContactOutline& outline, const Eigen::VectorXd& x, Eigen::Matrix2Xd& into) {
  into.resize(2, outline.points());
  for (int p = 0; p < outline.points(); ++p) {
    const Eigen::Index at = 2 * static_cast<Eigen::Index>(outline.nodes[static_cast<std::size_t>(p)]);
    into(0, p) = x[at];
    into(1, p) = x[at + 1];
  }
}

bool intersects(const ContactOutline& outline, const Eigen::VectorXd& x) {
  if (outline.segments.empty()) return false;
  const CellCoordinates coordinates{(x.size() - CellCoordinates::strain_components) / 2};
  const Eigen::Matrix2d gradient = coordinates.deformation_gradient(x);
  const Eigen::Matrix2d lattice = gradient * outline.lattice;
  Eigen::Matrix2Xd points;
  gather_displacements(outline, x, points);
  points += gradient * outline.rest;

  SegmentGrid grid;
  grid.build(outline, lattice, points, 0);
  bool found = false;
  for (std::size_t s = 0; s < outline.segments.size() && !found; ++s) {
    const ContactOutline::Segment& segment = outline.segments[s];
    const Eigen::Vector2d tail = points.col(segment.tail);
    const Eigen::Vector2d head = points.col(segment.head) + lattice * segment.head_shift.cast<double>();
    grid.visit((tail + head) / 2, (head - tail).norm() / 2, [&](int index, const Eigen::Vector2i& shift) {
      const ContactOutline::Segment& other = outline.segments[static_cast<std::size_t>(index)];
      const Eigen::Vector2i other_head_shift = shift + other.head_shift;
      // Segments with a common end meet there and nowhere else.
      if ((other.tail == segment.tail && shift.isZero()) ||
          (other.tail == segment.head && shift == segment.head_shift) ||
          (other.head == segment.tail && other_head_shift.isZero()) ||
          (other.head == segment.head && other_head_shift == segment.head_shift))
        return;
      const Eigen::Vector2d other_tail = points.col(other.tail) + lattice * shift.cast<double>();
      const Eigen::Vector2d other_head = points.col(other.head) + lattice * other_head_shift.cast<double>();
      found = found || segments_cross(tail, head, other_tail, other_head);
    });
  }
  return found;
}

}  // namespace supple::microscale
