#include "box_survey.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "defined_outline.h"
#include "polygon.h"
#include "supple/base/number_text.h"
#include "supple/base/sobol.h"

namespace supple::tiling {
namespace {

constexpr int survey_samples = 256;
constexpr int max_corner_dimensions = 6;  // 64 corners
/// Precision of the place where a crossing begins, as a fraction of the box.
constexpr double bisection_precision = 1e-6;
constexpr std::size_t max_reported_crossings = 10;

// What counts as a sliver: networks learn little where corners are sharper and sides or straits narrower than this.
constexpr double sliver_angle = 25 * std::numbers::pi / 180;
constexpr double min_width = 1.5;  ///< beam widths

std::vector<double> defaults_of(const FamilyDefinition& definition) {
  std::vector<double> result;
  for (const DefinedParameter& parameter : definition.parameters) result.push_back(parameter.range.preset);
  return result;
}

/// Points on the straight line between two parameter vectors.
std::vector<double> between(const std::vector<double>& from, const std::vector<double>& to, double fraction) {
  std::vector<double> result(from.size());
  for (std::size_t k = 0; k < from.size(); ++k) result[k] = from[k] + fraction * (to[k] - from[k]);
  return result;
}

/// Distance in the box scaled to the unit cube.
double box_distance(const FamilyDefinition& definition, const std::vector<double>& a, const std::vector<double>& b) {
  double squares = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const Parameter& range = definition.parameters[k].range;
    squares += std::pow((a[k] - b[k]) / (range.upper - range.lower), 2);
  }
  return std::sqrt(squares);
}

std::string list_text(const std::vector<double>& parameters) {
  std::string text;
  for (const double value : parameters) text += (text.empty() ? "" : ", ") + number_text(value);
  return "(" + text + ")";
}

std::string percent_text(int part, std::size_t whole) {
  return number_text(std::round(100.0 * part / static_cast<double>(whole))) + " % of the box";
}

/// The edge that the side of the outline is a piece of.
std::size_t edge_of(std::size_t side, const std::vector<std::size_t>& starts) {
  return static_cast<std::size_t>(std::upper_bound(starts.begin(), starts.end(), side) - starts.begin()) - 1;
}

/// A point where two sides of the outline meet, or one between them where they only come near each other.
Eigen::Vector2d meeting_point(const Polygon& tile, std::size_t i, std::size_t j) {
  const Eigen::Vector2d &a = tile[i], &b = tile[(i + 1) % tile.size()];
  const Eigen::Vector2d &c = tile[j], &d = tile[(j + 1) % tile.size()];
  const double across = cross(b - a, d - c);
  if (std::abs(across) > 1e-12 * (b - a).norm() * (d - c).norm()) {
    const double t = std::clamp(cross(c - a, d - c) / across, 0.0, 1.0);
    return a + t * (b - a);
  }
  return nearest_on_segment(c, a, b);
}

using EdgePair = std::pair<std::size_t, std::size_t>;

struct Crossing {
  EdgePair edges;
  Eigen::Vector2d point;
};

std::optional<Crossing> crossing_of(const FamilyDefinition& definition, const std::vector<double>& parameters) {
  const Polygon tile = tiling_at(definition, parameters).tiles[0];
  const auto sides = self_intersection(tile);
  if (!sides) return std::nullopt;
  const auto i = static_cast<std::size_t>(sides->first), j = static_cast<std::size_t>(sides->second);
  const auto starts = edge_starts(definition);
  const std::size_t a = edge_of(i, starts), b = edge_of(j, starts);
  return Crossing{{std::min(a, b), std::max(a, b)}, meeting_point(tile, i, j)};
}

DefinitionFinding finding_of(const Crossing& crossing, const std::vector<double>& parameters) {
  const auto [a, b] = crossing.edges;
  const std::string which = a == b ? "edge " + std::to_string(a) + " meets itself"
                                   : "edges " + std::to_string(a) + " and " + std::to_string(b) + " meet";
  return {DefinitionFlaw::crossing, "tile",
          "crosses itself: " + which + " at (" + number_text(crossing.point.x()) + ", " +
              number_text(crossing.point.y()) + ") where the parameters are " + list_text(parameters),
          parameters, crossing.point};
}

/// The narrowest corner, side or strait that was found, and in how many samples there was one too narrow.
struct Sliver {
  double size = INFINITY;
  std::size_t edge = 0;
  std::vector<double> parameters;
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  int samples = 0;

  void examine(double candidate, std::size_t at_edge, const Eigen::Vector2d& at, const std::vector<double>& where) {
    if (candidate >= size) return;
    size = candidate;
    edge = at_edge;
    parameters = where;
    point = at;
  }
};

/// The narrowest corner (rad), side and strait (beam widths) of one tile.
struct Slivers {
  Sliver corner, side, strait;

  bool any() const { return corner.size < sliver_angle || side.size < min_width || strait.size < min_width; }
};

void measure_strait(const Polygon& tile, const std::vector<std::size_t>& starts, const EdgePair& edges, double width,
                    const std::vector<double>& sample, Sliver& strait) {
  const auto from_points = [&](std::size_t points, std::size_t sides) {
    for (std::size_t i = starts[points]; i <= starts[points + 1]; ++i) {
      const Eigen::Vector2d& p = tile[i % tile.size()];
      for (std::size_t j = starts[sides]; j < starts[sides + 1]; ++j) {
        const Eigen::Vector2d nearest = nearest_on_segment(p, tile[j], tile[(j + 1) % tile.size()]);
        strait.examine((p - nearest).norm() / width, edges.first, (p + nearest) / 2, sample);
      }
    }
  };
  from_points(edges.first, edges.second);
  from_points(edges.second, edges.first);
}

Slivers slivers_at(const FamilyDefinition& definition, const std::vector<std::size_t>& starts,
                   const std::vector<double>& sample) {
  const Polygon tile = tiling_at(definition, sample).tiles[0];
  const double width = definition.beam_width(sample);
  Slivers slivers;
  const std::size_t edges = starts.size() - 1;
  for (std::size_t k = 0; k < edges; ++k) {
    const std::size_t start = starts[k], end = starts[k + 1] % tile.size();
    const Eigen::Vector2d& vertex = tile[start];
    const Eigen::Vector2d ahead = tile[(start + 1) % tile.size()] - vertex;
    const Eigen::Vector2d behind = tile[(start + tile.size() - 1) % tile.size()] - vertex;
    slivers.corner.examine(std::abs(std::atan2(cross(ahead, behind), ahead.dot(behind))), k, vertex, sample);
    slivers.side.examine((tile[end] - vertex).norm() / width, k, (tile[end] + vertex) / 2, sample);
    for (std::size_t other = k + 2; other < edges && !(k == 0 && other + 1 == edges); ++other)
      measure_strait(tile, starts, {k, other}, width, sample, slivers.strait);
  }
  return slivers;
}

class BoxSurvey {
 public:
  explicit BoxSurvey(const FamilyDefinition& definition)
      : definition_(definition),
        defaults_(defaults_of(definition)),
        starts_(edge_starts(definition)),
        samples_(box_samples(definition, definition.parameters.empty() ? 0 : survey_samples)) {}

  std::vector<DefinitionFinding> run(const Execution& execution) {
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      execution.checkpoint(0.5 + 0.4 * static_cast<double>(k) / static_cast<double>(samples_.size()), "survey");
      const std::vector<double>& sample = samples_[k];
      if (const auto crossing = crossing_of(definition_, sample)) {
        remember(crossing->edges, sample);
      } else {
        measure(sample);
      }
    }
    std::vector<DefinitionFinding> findings = crossings(execution);
    add_sliver(findings, corners_,
               "is the tip of a corner of " + number_text(corners_.size * 180 / std::numbers::pi) +
                   " degrees (slivers are below " + number_text(sliver_angle * 180 / std::numbers::pi) + ")");
    add_sliver(findings, sides_, "begins a side of " + number_text(sides_.size) + widths());
    add_sliver(findings, straits_,
               "begins an edge that is " + number_text(straits_.size) + widths("from another one "));
    return findings;
  }

 private:
  static std::string widths(const std::string& place = "") {
    return " beam widths " + place + "(slivers are below " + number_text(min_width) + ")";
  }

  /// Keeps the sample in which these edges cross that is nearest to the default.
  void remember(const EdgePair& edges, const std::vector<double>& sample) {
    ++crossing_samples_;
    const auto [entry, is_new] = nearest_.try_emplace(edges, sample);
    if (!is_new && box_distance(definition_, sample, defaults_) < box_distance(definition_, entry->second, defaults_))
      entry->second = sample;
  }

  /// Where a crossing begins on the way from the default to each of these samples. Several ways may lead to the same
  /// pair of edges.
  std::vector<DefinitionFinding> crossings(const Execution& execution) const {
    std::map<EdgePair, std::pair<std::vector<double>, Crossing>> first;
    for (const auto& [edges, sample] : nearest_) {
      execution.checkpoint(0.9, "survey");
      double good = 0, bad = 1;
      while (bad - good > bisection_precision) {
        const double middle = (good + bad) / 2;
        (crossing_of(definition_, between(defaults_, sample, middle)) ? bad : good) = middle;
      }
      const std::vector<double> at = between(defaults_, sample, bad);
      if (const auto crossing = crossing_of(definition_, at)) {
        const auto [entry, is_new] = first.try_emplace(crossing->edges, at, *crossing);
        if (!is_new &&
            box_distance(definition_, at, defaults_) < box_distance(definition_, entry->second.first, defaults_))
          entry->second = {at, *crossing};
      }
    }
    std::vector<DefinitionFinding> findings;
    for (const auto& [edges, place] : first) {
      if (findings.size() == max_reported_crossings) break;
      findings.push_back(finding_of(place.second, place.first));
      findings.back().message += "; tiles cross themselves in " + percent_text(crossing_samples_, samples_.size());
    }
    return findings;
  }

  void measure(const std::vector<double>& sample) {
    const Slivers here = slivers_at(definition_, starts_, sample);
    merge(corners_, here.corner, sliver_angle);
    merge(sides_, here.side, min_width);
    merge(straits_, here.strait, min_width);
  }

  static void merge(Sliver& worst, const Sliver& here, double limit) {
    const int samples = worst.samples + (here.size < limit);
    if (here.size < worst.size) worst = here;
    worst.samples = samples;
  }

  void add_sliver(std::vector<DefinitionFinding>& findings, const Sliver& sliver, const std::string& message) const {
    if (sliver.samples == 0) return;
    findings.push_back({DefinitionFlaw::sliver, "tile/vertices/" + std::to_string(sliver.edge),
                        message + " where the parameters are " + list_text(sliver.parameters) + "; there are some in " +
                            percent_text(sliver.samples, samples_.size()),
                        sliver.parameters, sliver.point});
  }

  const FamilyDefinition& definition_;
  std::vector<double> defaults_;
  std::vector<std::size_t> starts_;
  std::vector<std::vector<double>> samples_;
  std::map<EdgePair, std::vector<double>> nearest_;
  int crossing_samples_ = 0;
  Sliver corners_, sides_, straits_;
};

}  // namespace

std::vector<std::vector<double>> box_samples(const FamilyDefinition& definition, int spread) {
  const std::size_t dimensions = definition.parameters.size();
  const auto at = [&](const auto& fraction_of) {
    std::vector<double> sample;
    for (std::size_t k = 0; k < dimensions; ++k) {
      const Parameter& range = definition.parameters[k].range;
      sample.push_back(range.lower + fraction_of(k) * (range.upper - range.lower));
    }
    return sample;
  };
  std::vector<std::vector<double>> samples{defaults_of(definition)};
  if (dimensions == 0) return samples;
  for (unsigned corner = 0; corner < 1U << std::min<std::size_t>(dimensions, max_corner_dimensions); ++corner)
    samples.push_back(at([&](std::size_t k) { return corner >> k & 1U ? 1.0 : 0.0; }));
  const SobolSequence sequence("samples of a definition", 1);
  for (int k = 0; k < spread; ++k) {
    const auto point = sequence.point(static_cast<std::uint32_t>(k));
    samples.push_back(at([&](std::size_t dimension) { return point[dimension]; }));
  }
  return samples;
}

std::vector<DefinitionFinding> survey_box(const FamilyDefinition& definition, const Execution& execution) {
  return BoxSurvey(definition).run(execution);
}

std::optional<DefinitionFlaw> flaw_at(const FamilyDefinition& definition, const std::vector<double>& parameters) {
  if (area(tiling_at(definition, parameters).tiles[0]) <= 0 || crossing_of(definition, parameters))
    return DefinitionFlaw::crossing;
  if (slivers_at(definition, edge_starts(definition), parameters).any()) return DefinitionFlaw::sliver;
  return std::nullopt;
}

std::optional<DefinitionFinding> crossing_at(const FamilyDefinition& definition,
                                             const std::vector<double>& parameters) {
  if (const auto crossing = crossing_of(definition, parameters)) return finding_of(*crossing, parameters);
  return std::nullopt;
}

}  // namespace supple::tiling
