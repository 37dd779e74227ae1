#include "shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "areas.h"
#include "grid_cells.h"

namespace supple::outlines {
namespace {

/// Corners nearer to each other than this fraction of the tolerance are one.
constexpr double one_corner = 1e-3;
/// Polygons of less area, in squares of the tolerance, are no outlines.
constexpr double least_area = 1;
/// Outlines of more corners are simplified.
constexpr std::size_t most_plain_corners = 1'000;
/// Sides nearer to each other than this fraction of the tolerance touch.
constexpr double touching = 1e-4;
/// Areas that differ by less than this fraction are equal.
constexpr double equal_areas = 1e-6;
/// What closing open shapes one by one may differ from joining them, as a fraction of the area.
constexpr double same_filling = 0.01;
constexpr std::size_t most_told = 3;

class ShapeMaker {
 public:
  ShapeMaker(const RawDrawing& drawing, double tolerance, const Execution& execution)
      : drawing_(drawing), tolerance_(tolerance), execution_(execution), areas_(tolerance, extent(drawing)) {}

  Shapes make() {
    std::vector<Polyline> polylines = flattened();
    Chains chains = joined(polylines, tolerance_, execution_);
    result_.doubled = chains.doubled.size();
    for (const std::size_t k : chains.doubled) leave_out(polylines[k].source->what, "it lies over another line");
    tell_branches(chains);
    close(polylines, chains);
    unite_crossing();
    return std::move(result_);
  }

 private:
  static double extent(const RawDrawing& drawing) {
    double most = 1e-9;
    for (const Curve& curve : drawing.curves) {
      most = std::max(most, curve.begin.cwiseAbs().maxCoeff());
      for (const Piece& piece : curve.pieces)
        for_each_control_point(piece, [&most](const Point& p) { most = std::max(most, p.cwiseAbs().maxCoeff()); });
    }
    return most;
  }

  std::vector<Polyline> flattened() {
    Flattener flattener(tolerance_);
    std::vector<Polyline> polylines;
    polylines.reserve(drawing_.curves.size());
    for (std::size_t i = 0; i < drawing_.curves.size(); ++i) {
      if (i % curves_between_checks == 0) execution_.cancellation.throw_if_requested();
      const Curve& curve = drawing_.curves[i];
      // What will be simplified shares its tolerance between both.
      flattener.set_tolerance(curve.pieces.size() > most_plain_corners ? tolerance_ / 2 : tolerance_);
      Points points = flattener.flatten(curve);
      const double error = flattener.take_chord_error();
      if (points.size() < 2) {
        leave_out(curve.what, "it has no length");
        continue;
      }
      polylines.push_back({std::move(points), curve.closed, &curve, 1, error});
    }
    return polylines;
  }

  void tell_branches(const Chains& chains) {
    if (chains.branches.empty()) return;
    std::string words;
    for (std::size_t k = 0; k < std::min(chains.branches.size(), most_told); ++k) {
      const Point& p = chains.branches[k];
      words += (k == 0 ? "" : ", ") + ("(" + rounded(p.x()) + ", " + rounded(p.y()) + ")");
    }
    result_.warnings.push_back("More than two curves meet at " + words +
                               (chains.branches.size() > most_told ? " and elsewhere" : "") +
                               ": each of the areas between them is an outline.");
  }

  /// Makes shapes of what is closed, and of filled curves that stay open.
  void close(const std::vector<Polyline>& polylines, Chains& chains) {
    std::vector<std::vector<Polyline>> elements;
    elements.reserve(chains.polylines.size());
    constexpr std::size_t nowhere = SIZE_MAX;
    std::vector<std::size_t> place;  // in `elements`, of filled elements by their number
    std::set<std::size_t> across(chains.across.begin(), chains.across.end());
    const auto add = [&](Polyline polyline) {
      const Curve& curve = *polyline.source;
      const bool alone = polyline.curves == 1 && curve.is_filled;
      if (alone && curve.element >= place.size()) place.resize(curve.element + 1, nowhere);
      const std::size_t known = alone ? place[curve.element] : nowhere;
      if (known != nowhere) return elements[known].push_back(std::move(polyline));
      if (alone) place[curve.element] = elements.size();
      elements.emplace_back().push_back(std::move(polyline));
    };
    for (std::size_t k = 0; k < chains.polylines.size(); ++k) {
      Polyline& polyline = chains.polylines[k];
      if (polyline.closed) {
        if (polyline.curves > 1) tell_joined(polylines, chains.members[k], polyline, across.contains(k));
        add(std::move(polyline));
        continue;
      }
      // A browser closes each filled curve by a straight line.
      for (const std::size_t member : chains.members[k]) {
        const Polyline& own = polylines[member];
        const Curve& curve = *own.source;
        if (curve.is_filled && std::abs(area_of(own.points)) >= least_area * tolerance_ * tolerance_) {
          Polyline closed = own;
          closed.closed = true;
          add(std::move(closed));
        } else {
          result_.open.push_back(own);
        }
      }
    }
    for (std::size_t k = 0; k < elements.size(); ++k) {
      if (k % curves_between_checks == 0) execution_.cancellation.throw_if_requested();
      add_element(elements[k]);
    }
  }

  void tell_joined(const std::vector<Polyline>& polylines, const std::vector<std::size_t>& members,
                   const Polyline& polyline, bool is_across) {
    if (is_across)
      result_.warnings.push_back("Curves of several layers or groups close together, at " + polyline.source->what +
                                 ".");
    double filled = 0;
    for (const std::size_t member : members) {
      if (!polylines[member].source->is_filled) return;
      filled += std::abs(area_of(polylines[member].points));
    }
    const double whole = std::abs(area_of(polyline.points));
    if (filled > least_area * tolerance_ * tolerance_ && std::abs(filled - whole) > same_filling * whole)
      result_.warnings.push_back("Curves that are filled one by one were joined to one outline, at " +
                                 polyline.source->what + ".");
  }

  bool is_tiny(const Points& points) const {
    return points.size() < 3 || std::abs(area_of(points)) < least_area * tolerance_ * tolerance_;
  }

  /// Simplifies a polygon if it has very many corners.
  void tidy(Polyline& polyline) {
    drop_repeated(polyline.points, one_corner * tolerance_);
    if (polyline.points.size() <= most_plain_corners) {
      result_.chord_error = std::max(result_.chord_error, polyline.error);
      return;
    }
    const double left = tolerance_ - polyline.error;
    Points fewer = left > 0 ? simplified(polyline.points, left) : polyline.points;
    if (is_tiny(fewer) || fewer.size() == polyline.points.size()) {
      result_.chord_error = std::max(result_.chord_error, polyline.error);
      return;
    }
    result_.simplified += polyline.points.size() - fewer.size();
    result_.chord_error = std::max(result_.chord_error, polyline.error + left);
    polyline.points = std::move(fewer);
  }

  void add_element(std::vector<Polyline>& loops) {
    const Curve& first = *loops[0].source;
    Shape shape{{}, first.names, &first};
    shape.polygons.reserve(loops.size());
    for (Polyline& loop : loops) {
      tidy(loop);
      if (loop.curves > 1) {
        shape.curves += loop.curves;
        result_.joined += loop.curves;
      }
      if (loop.points.size() < 3) {
        leave_tiny(loop.source->what);
      } else {
        shape.polygons.push_back(std::move(loop.points));
      }
    }
    if (shape.polygons.empty()) return;
    fill(shape, first.rule);
    cut(shape, first.clip.get());
    drop_tiny(shape);
    if (!shape.polygons.empty()) result_.shapes.push_back(std::move(shape));
  }

  /// Counts what is left out, and keeps as many reasons as a drawing tells.
  void leave_out(const std::string& what, const char* reason) {
    ++result_.left_out_count;
    if (result_.left_out.size() < Drawing::most_left_out) result_.left_out.push_back({what, reason});
  }

  void leave_tiny(const std::string& what) {
    ++result_.tiny;
    leave_out(what, "it has no area");
  }

  void drop_tiny(Shape& shape) {
    const auto dropped = std::erase_if(shape.polygons, [this](const Points& points) { return is_tiny(points); });
    for (std::size_t k = 0; k < dropped; ++k) leave_tiny(shape.curve->what);
  }

  /// Whether a polygon of the shape crosses or touches itself or another one.
  bool is_tangled(const Shape& shape) const {
    const double distance = touching * tolerance_;
    const auto itself = [&](const Points& points) { return touches_itself(points, distance, execution_); };
    if (std::any_of(shape.polygons.begin(), shape.polygons.end(), itself)) return true;
    if (shape.polygons.size() < 2) return false;
    std::vector<const Points*> polygons;
    for (const Points& points : shape.polygons) polygons.push_back(&points);
    std::vector<std::size_t> owners(polygons.size());
    std::iota(owners.begin(), owners.end(), 0U);
    return !contacts(polygons, owners, distance, execution_).empty();
  }

  /// Makes polygons of the same area, by the even-odd rule, which do not cross themselves or each other.
  void fill(Shape& shape, FillRule rule) {
    drop_tiny(shape);
    if (is_tangled(shape)) {
      shape.polygons = areas_.filled(shape.polygons, rule);
    } else if (rule == FillRule::nonzero && shape.polygons.size() > 1) {
      drop_inner(shape);
    }
  }

  /// Drops the polygons on both sides of which the nonzero rule fills.
  void drop_inner(Shape& shape) {
    std::vector<Box> boxes;
    std::vector<int> turns;
    for (const Points& points : shape.polygons) {
      boxes.push_back(outlines::box_of(points));
      turns.push_back(area_of(points) > 0 ? 1 : -1);
    }
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < shape.polygons.size(); ++i) {
      if (i % curves_between_checks == 0) execution_.cancellation.throw_if_requested();
      int outside = 0;
      for (std::size_t j = 0; j < shape.polygons.size(); ++j) {
        if (j != i && boxes[j].contains(boxes[i]) && is_inside(shape.polygons[j], shape.polygons[i][0]))
          outside += turns[j];
      }
      if ((outside == 0) == (outside + turns[i] == 0)) {
        ++result_.inner;
        leave_out(shape.curve->what,
                  "a curve of it lies within another one of the same direction, and both are filled (nonzero)");
      } else {
        kept.push_back(i);
      }
    }
    if (kept.size() == shape.polygons.size()) return;
    std::vector<Points> left;
    left.reserve(kept.size());
    for (const std::size_t i : kept) left.push_back(std::move(shape.polygons[i]));
    shape.polygons = std::move(left);
  }

  const Area& area_of_clip(const Clip& clip) {
    const auto [found, is_new] = clips_.try_emplace(&clip);
    if (!is_new) return found->second;
    Flattener flattener(tolerance_);
    std::map<std::size_t, std::vector<const Curve*>> elements;
    for (const Curve& curve : clip.curves) elements[curve.element].push_back(&curve);
    Area whole;
    for (const auto& [element, curves] : elements) {
      std::vector<Points> polygons;
      for (const Curve* curve : curves) polygons.push_back(flattener.flatten(*curve));
      Area own = areas_.filled(polygons, curves[0]->rule);
      if (curves[0]->clip) own = areas_.common(own, area_of_clip(*curves[0]->clip));
      whole = whole.empty() ? own : areas_.united(whole, own);
    }
    result_.chord_error = std::max(result_.chord_error, flattener.take_chord_error());
    if (clip.outer) whole = areas_.common(whole, area_of_clip(*clip.outer));
    return clips_[&clip] = std::move(whole);
  }

  void cut(Shape& shape, const Clip* clip) {
    if (clip == nullptr) return;
    const Area& area = area_of_clip(*clip);
    Box box;
    for (const Points& points : shape.polygons) box.include(points);
    // A page as a clip path, which many programs write around everything, cuts nothing.
    if (area.size() == 1 && area[0].size() == 4) {
      const Box page = outlines::box_of(area[0]);
      const Eigen::Vector2d sides = page.upper - page.lower;
      if (page.contains(box) && std::abs(area_of(area[0]) - sides.prod()) <= equal_areas * sides.prod()) return;
    }
    const double before = AreaArithmetic::size(areas_.filled(shape.polygons, FillRule::evenodd));
    Area left = areas_.common(shape.polygons, area);
    const double after = AreaArithmetic::size(left);
    if (after >= before * (1 - equal_areas)) return;
    ++result_.clipped;
    if (after <= least_area * tolerance_ * tolerance_) {
      leave_out(shape.curve->what, "a clip path hides all of it");
      left.clear();
    }
    shape.polygons = std::move(left);
  }

  /// Drops polygons that lie over others, and unites the shapes of one group that cross.
  void unite_crossing() {
    drop_equal();
    auto& shapes = result_.shapes;
    std::vector<const Points*> polygons;
    std::vector<std::size_t> owner;
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      for (const Points& points : shapes[k].polygons) {
        polygons.push_back(&points);
        owner.push_back(k);
      }
    }
    std::set<std::pair<std::size_t, std::size_t>> pairs;
    for (const auto& [i, j] : contacts(polygons, owner, touching * tolerance_, execution_))
      pairs.insert(std::minmax(owner[i], owner[j]));
    std::vector<std::size_t> into(shapes.size());
    std::iota(into.begin(), into.end(), 0U);
    const auto root = [&into](std::size_t k) {
      while (into[k] != k) k = into[k] = into[into[k]];
      return k;
    };
    std::size_t looked = 0;
    std::vector<std::string> apart;
    std::vector<std::size_t> crossing;
    for (const auto& [i, j] : pairs) {
      if (looked++ % curves_between_checks == 0) execution_.cancellation.throw_if_requested();
      if (!overlap(shapes[i], shapes[j])) continue;
      if (shapes[i].curve->group == shapes[j].curve->group) {
        into[std::max(root(i), root(j))] = std::min(root(i), root(j));
        crossing.push_back(i);
        crossing.push_back(j);
      } else if (!is_region(shapes[i]) && !is_region(shapes[j])) {
        apart.push_back(shapes[i].curve->what + " and " + shapes[j].curve->what);
      }
    }
    if (!apart.empty()) {
      std::string words = apart[0];
      for (std::size_t k = 1; k < std::min(apart.size(), most_told); ++k) words += "; " + apart[k];
      result_.warnings.push_back("Shapes of different groups or layers cross each other: " + words +
                                 (apart.size() > most_told ? "; and others" : "") +
                                 ". In one outline, what lies within two of them is a hole.");
    }
    std::sort(crossing.begin(), crossing.end());
    crossing.erase(std::unique(crossing.begin(), crossing.end()), crossing.end());
    result_.united = crossing.size();
    for (const std::size_t k : crossing) {
      if (root(k) == k) continue;
      Shape& whole = shapes[root(k)];
      whole.polygons = areas_.united(whole.polygons, shapes[k].polygons);
      for (const std::string& name : shapes[k].names) {
        const bool known = std::find(whole.names.begin(), whole.names.end(), name) != whole.names.end();
        if (!known && whole.names.size() < most_names) whole.names.push_back(name);
      }
      shapes[k].polygons.clear();
    }
    for (Shape& shape : shapes) {
      if (!shape.polygons.empty()) drop_tiny(shape);
    }
    std::erase_if(shapes, [](const Shape& shape) { return shape.polygons.empty(); });
  }

  /// Whether a shape stands in a group or layer called "regions", in small letters or capitals: such a shape may cross
  /// the part of which it is a region.
  static bool is_region(const Shape& shape) {
    constexpr std::string_view regions = "regions";
    const auto is_same_letter = [](char a, char small) { return a == small || (a >= 'A' && a - 'A' + 'a' == small); };
    return std::any_of(shape.curve->names.begin(), shape.curve->names.end(), [&](const std::string& name) {
      return std::equal(name.begin(), name.end(), regions.begin(), regions.end(), is_same_letter);
    });
  }

  /// Whether two areas have one in common that is neither of them.
  bool overlap(const Shape& a, const Shape& b) const {
    const double both = AreaArithmetic::size(areas_.common(a.polygons, b.polygons));
    if (both <= least_area * tolerance_ * tolerance_) return false;
    const double first = AreaArithmetic::size(areas_.filled(a.polygons, FillRule::evenodd));
    const double second = AreaArithmetic::size(areas_.filled(b.polygons, FillRule::evenodd));
    return both < std::min(first, second) * (1 - equal_areas);
  }

  void drop_equal() {
    // Boxes by the cell of their lower corner. Cells are much larger than what equal boxes differ by, so that mostly
    // one cell is looked at.
    const double size = 16 * tolerance_;
    std::unordered_map<GridCell, std::vector<const Points*>, GridCell::Hash> cells;
    cells.reserve(result_.shapes.size());
    for (Shape& shape : result_.shapes) {
      std::vector<Points> kept;
      kept.reserve(shape.polygons.size());
      for (Points& points : shape.polygons) {
        const Box box = outlines::box_of(points);
        const bool found = any_cell_near(box.lower, tolerance_, size, [&](const GridCell& cell) {
          const auto near = cells.find(cell);
          return near != cells.end() && std::any_of(near->second.begin(), near->second.end(), [&](const Points* known) {
                   return is_same_curve(*known, points, tolerance_, true);
                 });
        });
        if (found) {
          ++result_.equal;
          leave_out(shape.curve->what, "it lies over another outline, which counts once");
          continue;
        }
        kept.push_back(std::move(points));
        cells[cell_of(box.lower, size)].push_back(&kept.back());
      }
      // The points stay where they are in memory: their places were reserved, and vectors move as they are.
      shape.polygons = std::move(kept);
    }
    std::erase_if(result_.shapes, [](const Shape& shape) { return shape.polygons.empty(); });
  }

  const RawDrawing& drawing_;
  double tolerance_;
  const Execution& execution_;
  AreaArithmetic areas_;
  std::map<const Clip*, Area> clips_;
  Shapes result_;
};

}  // namespace

Box Shapes::box() const {
  Box box;
  for (const Shape& shape : shapes) {
    for (const Points& points : shape.polygons) box.include(points);
  }
  return box;
}

Shapes shapes_of(const RawDrawing& drawing, double tolerance, const Execution& execution) {
  return ShapeMaker(drawing, tolerance, execution).make();
}

}  // namespace supple::outlines
