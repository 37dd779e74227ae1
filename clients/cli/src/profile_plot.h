#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace supple::cli {

/// Curves of one picture over common x; values that are missing are not a number, curves that are missing empty.
struct ProfilePlot {
  std::string title;
  std::string subtitle;
  bool polar = false;   ///< x are angles in rad with period pi
  std::string x_label;  ///< of the axes; not drawn where polar
  std::string y_label;
  std::vector<double> x;
  std::vector<double> target;
  std::vector<double> initial;
  std::vector<double> achieved;
  std::string achieved_name = "achieved";
  std::vector<bool> in_range;  ///< of the achieved values
  std::vector<double> lower;   ///< envelope
  std::vector<double> upper;
  std::vector<double> verified_x;
  std::vector<double> verified;
};

/// The numbers of an array; what is null is not a number.
std::vector<double> values_of(const nlohmann::json& array);

/// One picture for each target of each region of an answer of /v1/designs.
std::vector<ProfilePlot> plots_of_designs(const nlohmann::json& answer);
/// The picture of an answer of /v1/profiles.
ProfilePlot plot_of_profile(const nlohmann::json& answer);

/// The pictures side by side as one SVG file.
std::string plot_svg(const std::vector<ProfilePlot>& plots);

}  // namespace supple::cli
