#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "part_supports.h"
#include "supple/base/number_text.h"

namespace supple::microscale {
namespace {

/// Number of places along the path at which supports are checked for collisions.
constexpr int collision_checks = 64;

std::string place_of(std::size_t support) { return "supports/" + std::to_string(support); }

Eigen::Vector2d displacement_of(const Support& support) {
  return std::visit([](const auto& s) { return s.displacement; }, support);
}

void check_plate(const Plate& plate, const std::string& where, double max_gap, std::vector<Error::Detail>& details) {
  if (!(plate.gap >= 0 && plate.gap <= max_gap))
    details.push_back({where + "/gap", "must lie between 0 and " + number_text(max_gap) +
                                           " mm, the larger side of the part, but is " + number_text(plate.gap)});
}

void check_clamp(const Clamp& clamp, const std::string& where, std::vector<Error::Detail>& details) {
  if (!clamp.lower.allFinite() || !clamp.upper.allFinite() || (clamp.lower.array() > clamp.upper.array()).any())
    details.push_back({where + "/box", "must be a corner with the lesser and one with the greater coordinates"});
}

}  // namespace

InvalidLoad invalid_supports(const std::vector<Error::Detail>& details) {
  return InvalidLoad("simulation.invalid_load",
                     "The part cannot be supported so: " + details.front().where + " " + details.front().message + ".",
                     details);
}

void check_supports(const std::vector<Support>& supports, const Eigen::Vector2d& lower, const Eigen::Vector2d& upper) {
  std::vector<Error::Detail> details;
  if (supports.empty()) details.push_back({"supports", "must be at least one"});
  const double max_length = (upper - lower).maxCoeff();
  std::array<int, 4> plate_on{-1, -1, -1, -1};
  for (std::size_t k = 0; k < supports.size(); ++k) {
    const std::string where = place_of(k);
    const Eigen::Vector2d displacement = displacement_of(supports[k]);
    if (!(displacement.cwiseAbs().maxCoeff() <= max_length))
      details.push_back({where + "/displacement", "must not be longer than " + number_text(max_length) +
                                                      " mm, the larger side of the part, along either axis"});
    if (const auto* plate = std::get_if<Plate>(&supports[k])) {
      check_plate(*plate, where, max_length, details);
      int& other = plate_on[static_cast<std::size_t>(plate->side)];
      if (other >= 0)
        details.push_back({where + "/side", "has the plate of support " + std::to_string(other) + " already"});
      other = static_cast<int>(k);
    } else {
      check_clamp(std::get<Clamp>(supports[k]), where, details);
    }
  }
  if (!details.empty()) throw invalid_supports(details);
}

void PartSupports::check_collisions() const {
  std::vector<Error::Detail> details;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(mesh_.nodes.size());
  Eigen::VectorXd end = rest;
  impose(at_rest_, 1, end);  // clamps alone hold nodes so far
  for (const Surface& surface : surfaces_) {
    const std::string where = place_of(static_cast<std::size_t>(surface.support)) + "/displacement";
    for (const Surface& other : surfaces_) {
      const double apart = surface.sign * (other.position + other.rate - surface.position - surface.rate);
      if (other.axis == surface.axis && other.sign != surface.sign && other.support < surface.support && !(apart > 0))
        details.push_back({where, "moves the plate through that of support " + std::to_string(other.support) + ", by " +
                                      number_text(-apart) + " mm"});
    }
    double least = 0;
    int by = 0;
    for (Eigen::Index node = 0; node < mesh_.nodes.cols(); ++node) {
      if (!at_rest_.fixes(2 * node)) continue;
      const double distance = gap(surface, static_cast<int>(node), end, 1);
      if (distance >= std::min(least, -1e-6 * mesh_.mesh_size)) continue;
      least = distance;
      by = at_rest_.support[static_cast<std::size_t>(2 * node)];
    }
    if (least < 0)
      details.push_back({where, "moves the plate into points that support " + std::to_string(by) + " holds, by " +
                                    number_text(-least) + " mm"});
  }
  struct Box {
    Eigen::Array2d lower = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Array2d upper = -lower;
  };
  std::vector<Box> boxes(supports_.size());
  for (Eigen::Index node = 0; node < mesh_.nodes.cols(); ++node) {
    if (!at_rest_.fixes(2 * node)) continue;
    Box& box = boxes[static_cast<std::size_t>(at_rest_.support[static_cast<std::size_t>(2 * node)])];
    box.lower = box.lower.min(mesh_.nodes.col(node).array());
    box.upper = box.upper.max(mesh_.nodes.col(node).array());
  }
  const auto meet = [&](std::size_t k, std::size_t l, double fraction) {
    const Eigen::Array2d motion = fraction * (displacement_of(supports_[k]) - displacement_of(supports_[l])).array();
    return ((boxes[k].lower + motion <= boxes[l].upper) && (boxes[l].lower <= boxes[k].upper + motion)).all();
  };
  for (std::size_t k = 0; k < boxes.size(); ++k)
    for (std::size_t l = 0; l < k; ++l) {
      if (meet(k, l, 0)) continue;  // clamps of a bent region; their nodes keep their distances only each
      for (int step = 1; step <= collision_checks; ++step)
        if (meet(k, l, static_cast<double>(step) / collision_checks)) {
          details.push_back(
              {place_of(k) + "/displacement", "moves the clamped points onto those of support " + std::to_string(l)});
          break;
        }
    }
  if (!details.empty()) throw invalid_supports(details);
}

}  // namespace supple::microscale
