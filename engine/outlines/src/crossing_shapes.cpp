// Shapes that lie over each other.
#include <algorithm>
#include <numeric>
#include <set>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "grid_cells.h"
#include "shape_areas.h"

namespace supple::outlines {
namespace {

/// Drops polygons that lie over others.
void drop_duplicate_polygons(Shapes& result, double tolerance) {
  // Polygons by the cell in which the lower corner of their box lies. Cells are much larger than the distance of
  // equal corners, so that mostly one cell is searched.
  const double size = 16 * tolerance;
  std::unordered_map<GridCell, std::vector<const Points*>, GridCell::Hash> cells;
  cells.reserve(result.shapes.size());
  for (Shape& shape : result.shapes) {
    std::vector<Points> retained;
    retained.reserve(shape.polygons.size());
    for (Points& points : shape.polygons) {
      const Box box = box_of(points);
      const bool found = any_cell_near(box.lower, tolerance, size, [&](const GridCell& cell) {
        const auto near = cells.find(cell);
        return near != cells.end() && std::any_of(near->second.begin(), near->second.end(), [&](const Points* known) {
                 return is_same_curve(*known, points, tolerance, true);
               });
      });
      if (found) {
        ++result.duplicate_polygons;
        result.leave_out(shape.curve->description, "it lies over another outline, which counts once");
        continue;
      }
      retained.push_back(std::move(points));
      cells[cell_of(box.lower, size)].push_back(&retained.back());
    }
    // The pointers in `cells` stay valid: `retained` never reallocates, and moving a vector leaves its elements in
    // place.
    shape.polygons = std::move(retained);
  }
  std::erase_if(result.shapes, [](const Shape& shape) { return shape.polygons.empty(); });
}

/// Whether a shape is in a group or layer called "regions", in small letters or capitals. Such a shape may cross the
/// part of which it is a region.
bool is_region(const Shape& shape) {
  constexpr std::string_view regions = "regions";
  const auto is_same_letter = [](char a, char small) { return a == small || (a >= 'A' && a - 'A' + 'a' == small); };
  return std::any_of(shape.curve->names.begin(), shape.curve->names.end(), [&](const std::string& name) {
    return std::equal(name.begin(), name.end(), regions.begin(), regions.end(), is_same_letter);
  });
}

void warn_of_crossing_groups(const std::vector<std::string>& crossing_groups, Shapes& result) {
  if (crossing_groups.empty()) return;
  std::string words = crossing_groups[0];
  for (std::size_t k = 1; k < std::min(crossing_groups.size(), max_named_places); ++k)
    words += "; " + crossing_groups[k];
  result.warnings.push_back("Shapes of different groups or layers cross each other: " + words +
                            (crossing_groups.size() > max_named_places ? "; and others" : "") +
                            ". In one outline, what lies within two of them is a hole.");
}

}  // namespace

void unite_crossing(Shapes& result, const ShapeAreas& areas) {
  drop_duplicate_polygons(result, areas.tolerance());
  auto& shapes = result.shapes;
  std::vector<const Points*> polygons;
  std::vector<std::size_t> owners;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    for (const Points& points : shapes[k].polygons) {
      polygons.push_back(&points);
      owners.push_back(k);
    }
  }
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [i, j] : areas.contacts(polygons, owners)) pairs.insert(std::minmax(owners[i], owners[j]));
  std::vector<std::size_t> parents(shapes.size());
  std::iota(parents.begin(), parents.end(), 0U);
  const auto root = [&parents](std::size_t k) {
    while (parents[k] != k) k = parents[k] = parents[parents[k]];
    return k;
  };
  std::size_t checked_pairs = 0;
  std::vector<std::string> crossing_groups;
  std::vector<std::size_t> crossing;
  for (const auto& [i, j] : pairs) {
    if (checked_pairs++ % curves_between_checks == 0) areas.execution().cancellation.throw_if_requested();
    if (!areas.overlap(shapes[i], shapes[j])) continue;
    if (shapes[i].curve->group == shapes[j].curve->group) {
      parents[std::max(root(i), root(j))] = std::min(root(i), root(j));
      crossing.push_back(i);
      crossing.push_back(j);
    } else if (!is_region(shapes[i]) && !is_region(shapes[j])) {
      crossing_groups.push_back(shapes[i].curve->description + " and " + shapes[j].curve->description);
    }
  }
  warn_of_crossing_groups(crossing_groups, result);
  std::sort(crossing.begin(), crossing.end());
  crossing.erase(std::unique(crossing.begin(), crossing.end()), crossing.end());
  result.united = crossing.size();
  for (const std::size_t k : crossing) {
    if (root(k) == k) continue;
    Shape& whole = shapes[root(k)];
    whole.polygons = areas.arithmetic().united(whole.polygons, shapes[k].polygons);
    for (const std::string& name : shapes[k].names) {
      const bool known = std::find(whole.names.begin(), whole.names.end(), name) != whole.names.end();
      if (!known && whole.names.size() < max_names) whole.names.push_back(name);
    }
    shapes[k].polygons.clear();
  }
  for (Shape& shape : shapes) {
    if (!shape.polygons.empty()) areas.drop_tiny(shape, result);
  }
  std::erase_if(shapes, [](const Shape& shape) { return shape.polygons.empty(); });
}

}  // namespace supple::outlines
