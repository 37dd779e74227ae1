#include <algorithm>
#include <limits>

#include "supple/design/family_atlas.h"

namespace supple::design {
namespace {

/// The shapes of the solved samples of an atlas, and which samples they are of.
struct SampledShapes {
  const FamilyAtlas* atlas;
  std::vector<RestShape> shapes;
  std::vector<std::size_t> samples;

  explicit SampledShapes(const FamilyAtlas& from) : atlas(&from) {
    for (std::size_t i = 0; i < from.samples.size(); ++i) {
      if (!from.samples[i].compliance) continue;
      shapes.emplace_back(*from.samples[i].compliance);
      samples.push_back(i);
    }
  }

  double distance_from(const RestShape& shape, double no_farther_than) const {
    double nearest = no_farther_than;
    for (const RestShape& other : shapes)
      if (shape.min_distance(other) < nearest) nearest = std::min(nearest, shape.distance(other));
    return nearest;
  }
};

std::vector<AtlasComparison::Profile> nearest_of_others(const FamilyAtlas& atlas,
                                                        const std::vector<SampledShapes>& others) {
  std::vector<AtlasComparison::Profile> result;
  for (const AtlasProfile& profile : atlas.profiles) {
    const AtlasProfile* nearest = nullptr;
    const FamilyAtlas* family = nullptr;
    for (const SampledShapes& other : others) {
      for (const AtlasProfile& candidate : other.atlas->profiles) {
        if (candidate.name != profile.name) continue;
        if (nearest && nearest->distance.deviation <= candidate.distance.deviation) continue;
        nearest = &candidate;
        family = other.atlas;
      }
    }
    if (nearest) result.push_back({family->family, nearest->distance});
  }
  return result;
}

/// The other family that has every shape of this one.
std::optional<std::string> same_family(const SampledShapes& own, const std::vector<SampledShapes>& others) {
  for (const SampledShapes& other : others) {
    const auto has = [&](const RestShape& shape) {
      return other.distance_from(shape, 2 * same_distance) <= same_distance;
    };
    if (std::all_of(own.shapes.begin(), own.shapes.end(), has)) return other.atlas->family;
  }
  return std::nullopt;
}

}  // namespace

std::optional<AtlasComparison> compare(const FamilyAtlas& atlas, std::span<const FamilyAtlas* const> others) {
  const SampledShapes own(atlas);
  std::vector<SampledShapes> compared;
  for (const FamilyAtlas* other : others) {
    if (other->family == atlas.family) continue;
    SampledShapes shapes(*other);
    if (!shapes.shapes.empty()) compared.push_back(std::move(shapes));
  }
  if (own.shapes.empty() || compared.empty()) return std::nullopt;
  AtlasComparison comparison;
  comparison.profiles = nearest_of_others(atlas, compared);
  std::vector<double> distances;
  std::size_t is_new = 0;
  for (std::size_t i = 0; i < own.shapes.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const SampledShapes& other : compared) nearest = other.distance_from(own.shapes[i], nearest);
    if (nearest > new_distance) ++is_new;
    if (distances.empty() || nearest > comparison.largest_distance) {
      comparison.largest_distance = nearest;
      comparison.farthest_sample = own.samples[i];
    }
    distances.push_back(nearest);
  }
  comparison.new_fraction = static_cast<double>(is_new) / static_cast<double>(distances.size());
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  comparison.median_distance = *middle;
  comparison.same_as = same_family(own, compared);
  return comparison;
}

}  // namespace supple::design
