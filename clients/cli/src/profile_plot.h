#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace supple::cli {

/// The curves of one picture over common x. Missing values are NaN, missing curves are empty.
struct ProfilePlot {
  std::string title;
  std::string subtitle;
  bool polar = false;   ///< whether x are angles in rad with period pi
  std::string x_label;  ///< labels of the axes, which polar plots do not draw
  std::string y_label;
  std::vector<double> x;
  std::vector<double> target;
  std::vector<double> initial;
  std::vector<double> achieved;
  std::string achieved_name = "achieved";
  std::vector<bool> in_range;  ///< whether the model was trained on such an achieved value
  std::vector<double> lower;   ///< envelope of what the family can achieve
  std::vector<double> upper;
  std::vector<double> bound;  ///< nearest that any material can have at rest; empty if it is the target, or unknown
  std::vector<double> verified_x;
  std::vector<double> verified;
};

/// The numbers of an array; null becomes NaN.
std::vector<double> values_of(const nlohmann::json& array);

/// A plot for each target of each region of an answer of /v1/designs.
std::vector<ProfilePlot> plots_of_designs(const nlohmann::json& answer);
/// The plot of an answer of /v1/profiles.
ProfilePlot plot_of_profile(const nlohmann::json& answer);

/// The plots side by side as one SVG file.
std::string plot_svg(const std::vector<ProfilePlot>& plots);

}  // namespace supple::cli
