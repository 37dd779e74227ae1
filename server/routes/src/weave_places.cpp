#include <limits>
#include <utility>

#include "supple/weave/places.h"
#include "weave_spec.h"

namespace supple::routes {
namespace {

using weave::Weave;
using Place = weave::StrandPlace;

Error no_place(const std::string& where, const std::string& message) {
  return {"weave.invalid_load", where.substr(1) + " " + message, {{where, message}}};
}

/// Finds the places that each form of a place means.
class PlaceFinder {
 public:
  PlaceFinder(const Weave& weave, std::string where) : weave_(weave), where_(std::move(where)) {}

  std::vector<Place> operator()(const json::StrandCoordinate& at) const {
    check_strand(at.strand);
    return {{at.strand, at.coordinate}};
  }
  std::vector<Place> operator()(const json::StrandFraction& at) const {
    check_strand(at.strand);
    return {{at.strand, at.share * weave_.strands[static_cast<std::size_t>(at.strand)].curve.length()}};
  }
  std::vector<Place> operator()(const json::AtCrossing& at) const {
    if (static_cast<std::size_t>(at.crossing) >= weave_.crossings.size())
      throw no_place(where_ + "/crossing", "names no crossing: there are " + std::to_string(weave_.crossings.size()));
    return {weave::place_of(weave_.crossings[static_cast<std::size_t>(at.crossing)])};
  }
  std::vector<Place> operator()(const json::InBox& box) const {
    auto places = weave::places_in(weave_, box.lower, box.upper);
    if (places.empty()) throw no_place(where_ + "/box", "holds no crossing and no end of a strand");
    return places;
  }

 private:
  void check_strand(int strand) const {
    if (static_cast<std::size_t>(strand) >= weave_.strands.size())
      throw no_place(where_ + "/strand", "names no strand: there are " + std::to_string(weave_.strands.size()));
  }

  const Weave& weave_;
  std::string where_;
};

std::vector<Place> find_places(const json::PlaceSpec& at, const Weave& weave, const std::string& where) {
  return std::visit(PlaceFinder(weave, where + "/at"), at);
}

}  // namespace

PlacedLoad place_load(const json::WeaveSimulationRequest& request, const Weave& weave, const json::Limits& limits,
                      const Execution& execution) {
  PlacedLoad placed;
  const auto check_count = [&](const std::string& where) {
    const std::size_t places = placed.places.size() + placed.force_of.size();
    if (places > limits.max_load_points)
      problem::throw_limit("request.limit_exceeded", "The number of places that are held or pulled, with all of a box,",
                           static_cast<double>(limits.max_load_points), static_cast<double>(places), "", where);
  };
  placed.load.states = request.states;
  for (std::size_t i = 0; i < request.supports.size(); ++i) {
    execution.cancellation.throw_if_requested();
    const auto& spec = request.supports[i];
    for (const auto& place : find_places(spec.at, weave, "/supports/" + std::to_string(i))) {
      auto& support = placed.load.supports.emplace_back(spec.support);
      support.strand = place.strand;
      support.coordinate = place.coordinate;
      placed.places.push_back({static_cast<int>(i), place.strand, place.coordinate});
    }
    check_count("/supports/" + std::to_string(i));
  }
  for (std::size_t i = 0; i < request.forces.size(); ++i) {
    execution.cancellation.throw_if_requested();
    const auto& spec = request.forces[i];
    const auto places = find_places(spec.at, weave, "/forces/" + std::to_string(i));
    for (const auto& place : places) {
      placed.load.forces.push_back({place.strand, place.coordinate, spec.force / static_cast<double>(places.size())});
      placed.force_of.push_back(static_cast<int>(i));
    }
    check_count("/forces/" + std::to_string(i));
  }
  return placed;
}

PointerMap load_pointers(const PlacedLoad& placed) {
  const auto support = [&places = placed.places](std::size_t i) {
    return "/supports/" + std::to_string(places.at(i).support);
  };
  const auto force = [&force_of = placed.force_of](std::size_t i) {
    return "/forces/" + std::to_string(force_of.at(i));
  };
  return PointerMap("", {{.field = "supports", .pointer_of_entry = support},
                         {.field = "forces", .pointer_of_entry = force},
                         {.field = "lattice", .pointer = "/weave"}});
}

}  // namespace supple::routes
