#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include "solid_files.h"

namespace supple::tiling {
namespace {

using Eigen::Vector2d;

// This writer does not use OpenCASCADE through gmsh, which takes 1.5 ms and 4 kB for each corner, a thousand times as
// long, writes dates into files and prints to standard output. The tests read the files back with it.

/// Sides between two checks for a stop request.
constexpr std::size_t sides_between_checks = 1'024;

/// A real number of a STEP file: the shortest text with a decimal point that reads back as the same value.
std::string real(double value) {
  char digits[40];
  const auto end = std::to_chars(digits, digits + sizeof digits, value == 0 ? 0 : value).ptr;
  std::string text(digits, end);
  const auto exponent = text.find('e');
  if (text.find('.') == std::string::npos) text.insert(exponent == std::string::npos ? text.size() : exponent, ".");
  if (const auto e = text.find('e'); e != std::string::npos) text[e] = 'E';
  return text;
}

std::string reference(int entity) { return "#" + std::to_string(entity); }

std::string references(const std::vector<int>& entities) {
  std::string list = "(";
  for (const int entity : entities) {
    if (list.size() > 1) list += ',';
    list += reference(entity);
  }
  return list + ")";
}

/// Numbers entities in the order in which they are written.
class StepWriter {
 public:
  int add(const std::string& entity) {
    text_ += reference(++count_) + "=" + entity + ";\n";
    return count_;
  }
  int point(const Vector2d& p, double z) {
    return add("CARTESIAN_POINT('',(" + real(p.x()) + "," + real(p.y()) + "," + real(z) + "))");
  }
  int direction(double x, double y, double z) {
    return add("DIRECTION('',(" + real(x) + "," + real(y) + "," + real(z) + "))");
  }
  int vertex(int at) { return add("VERTEX_POINT(''," + reference(at) + ")"); }
  /// A straight edge between two vertices, along a direction from the point of the first.
  int edge(int from, int to, int begin, int along) {
    const int vector = add("VECTOR(''," + reference(along) + ",1.)");
    const int line = add("LINE(''," + reference(begin) + "," + reference(vector) + ")");
    return add("EDGE_CURVE(''," + reference(from) + "," + reference(to) + "," + reference(line) + ",.T.)");
  }
  int oriented(int edge, bool forwards) {
    return add("ORIENTED_EDGE('',*,*," + reference(edge) + (forwards ? ",.T.)" : ",.F.)"));
  }
  int bound(const std::vector<int>& oriented_edges, bool outer) {
    const int loop = add("EDGE_LOOP(''," + references(oriented_edges) + ")");
    return add((outer ? "FACE_OUTER_BOUND(''," : "FACE_BOUND('',") + reference(loop) + ",.T.)");
  }
  int placement(int at, int normal, int along) {
    return add("AXIS2_PLACEMENT_3D(''," + reference(at) + "," + reference(normal) + "," + reference(along) + ")");
  }
  int face(const std::vector<int>& bounds, int at, int normal, int along) {
    const int plane = add("PLANE(''," + reference(placement(at, normal, along)) + ")");
    return add("ADVANCED_FACE(''," + references(bounds) + "," + reference(plane) + ",.T.)");
  }
  std::string finish() { return std::move(text_); }

 private:
  std::string text_;
  int count_ = 0;
};

/// The edges of the walls over a polygon that also bound the top and the bottom face, in the polygon's order.
struct WallEdges {
  std::vector<int> top, bottom;
};

class PrismWriter {
 public:
  PrismWriter(StepWriter& step, double thickness, const Execution& execution)
      : step_(step), thickness_(thickness), execution_(execution) {
    up_ = step_.direction(0, 0, 1);
    down_ = step_.direction(0, 0, -1);
    right_ = step_.direction(1, 0, 0);
  }

  int up() const { return up_; }
  int right() const { return right_; }

  /// Writes the prism over a face of the plane.
  int solid(const Face& face) {
    std::vector<int> shell, top, bottom;
    for (const Polygon& polygon : face) {
      const WallEdges walls = add_walls(polygon, shell);
      const bool outer = top.empty();
      std::vector<int> edges;
      for (const int edge : walls.top) edges.push_back(step_.oriented(edge, true));
      top.push_back(step_.bound(edges, outer));
      edges.clear();
      for (auto edge = walls.bottom.rbegin(); edge != walls.bottom.rend(); ++edge)
        edges.push_back(step_.oriented(*edge, false));
      bottom.push_back(step_.bound(edges, outer));
    }
    shell.push_back(step_.face(top, step_.point(face[0][0], thickness_), up_, right_));
    shell.push_back(step_.face(bottom, step_.point(face[0][0], 0), down_, right_));
    return step_.add("MANIFOLD_SOLID_BREP(''," + reference(step_.add("CLOSED_SHELL(''," + references(shell) + ")")) +
                     ")");
  }

 private:
  /// Writes a wall for each side. The material lies on the left of a side.
  WallEdges add_walls(const Polygon& polygon, std::vector<int>& shell) {
    const std::size_t n = polygon.size();
    std::vector<int> low_points, low, high_points, high, posts;
    for (const Vector2d& p : polygon) {
      check();
      low_points.push_back(step_.point(p, 0));
      high_points.push_back(step_.point(p, thickness_));
      low.push_back(step_.vertex(low_points.back()));
      high.push_back(step_.vertex(high_points.back()));
      posts.push_back(step_.edge(low.back(), high.back(), low_points.back(), up_));
    }
    WallEdges walls;
    for (std::size_t k = 0; k < n; ++k) {
      check();
      const std::size_t next = (k + 1) % n;
      const Vector2d along = (polygon[next] - polygon[k]).normalized();
      const int direction = step_.direction(along.x(), along.y(), 0);
      const int outwards = step_.direction(along.y(), -along.x(), 0);
      walls.bottom.push_back(step_.edge(low[k], low[next], low_points[k], direction));
      walls.top.push_back(step_.edge(high[k], high[next], high_points[k], direction));
      const std::vector<int> edges{step_.oriented(walls.bottom.back(), true), step_.oriented(posts[next], true),
                                   step_.oriented(walls.top.back(), false), step_.oriented(posts[k], false)};
      shell.push_back(step_.face({step_.bound(edges, true)}, low_points[k], outwards, direction));
    }
    return walls;
  }

  void check() {
    if (++sides_ % sides_between_checks == 0) execution_.cancellation.throw_if_requested();
  }

  StepWriter& step_;
  double thickness_;
  const Execution& execution_;
  int up_ = 0, down_ = 0, right_ = 0;
  std::size_t sides_ = 0;
};

/// Writes the units, millimetres and radians, and the distance below which points coincide.
int add_units(StepWriter& step) {
  const int length = step.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
  const int angle = step.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
  const int solid_angle = step.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
  const int uncertainty = step.add("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07)," + reference(length) +
                                   ",'distance_accuracy_value','confusion accuracy')");
  return step.add("(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((" + reference(uncertainty) +
                  "))GLOBAL_UNIT_ASSIGNED_CONTEXT(" + references({length, angle, solid_angle}) +
                  ")REPRESENTATION_CONTEXT('part','3D'))");
}

/// Writes the product to which the shape belongs.
void add_product(StepWriter& step, const std::string& name, int shape) {
  const int application = step.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')");
  step.add("APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000," +
           reference(application) + ")");
  const int context = step.add("PRODUCT_CONTEXT(''," + reference(application) + ",'mechanical')");
  const int product = step.add("PRODUCT('" + name + "','" + name + "','',(" + reference(context) + "))");
  step.add("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(" + reference(product) + "))");
  const int formation = step.add("PRODUCT_DEFINITION_FORMATION('',''," + reference(product) + ")");
  const int stage = step.add("PRODUCT_DEFINITION_CONTEXT('part definition'," + reference(application) + ",'design')");
  const int definition =
      step.add("PRODUCT_DEFINITION('design',''," + reference(formation) + "," + reference(stage) + ")");
  const int definition_shape = step.add("PRODUCT_DEFINITION_SHAPE('',''," + reference(definition) + ")");
  step.add("SHAPE_DEFINITION_REPRESENTATION(" + reference(definition_shape) + "," + reference(shape) + ")");
}

}  // namespace

std::string step_of(const std::vector<Face>& faces, double thickness, const std::string& title,
                    const Execution& execution) {
  StepWriter step;
  PrismWriter prisms(step, thickness, execution);
  std::vector<int> items{step.placement(step.point(Vector2d::Zero(), 0), prisms.up(), prisms.right())};
  for (const Face& face : faces) items.push_back(prisms.solid(face));
  const int shape =
      step.add("ADVANCED_BREP_SHAPE_REPRESENTATION(''," + references(items) + "," + reference(add_units(step)) + ")");
  add_product(step, title, shape);
  // The date is a fixed one, so that equal solids have equal files.
  return "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('" + title + "'),'2;1');\nFILE_NAME('" + title +
         "','1970-01-01T00:00:00',(''),(''),'Supple','Supple','');\n"
         "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n" +
         step.finish() + "ENDSEC;\nEND-ISO-10303-21;\n";
}

}  // namespace supple::tiling
