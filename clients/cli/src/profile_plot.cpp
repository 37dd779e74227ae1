#include "profile_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "design_output.h"
#include "plot_axes.h"

namespace supple::cli {
namespace {

using std::numbers::pi;

constexpr double legend_line_height = 18;
/// Largest number of panels side by side.
constexpr std::size_t panels_per_row = 3;

// The target is a wide pale line under the result, so that both are visible where they agree.
constexpr auto envelope_color = "#edf1f7";
constexpr auto target_color = "#f3b562";
constexpr auto achieved_color = "#1f4e9c";
constexpr auto initial_color = "#98a4ae";
constexpr auto verified_color = "#c2362f";
constexpr auto bound_color = "#6b7680";
constexpr auto bound_dashes = " stroke-dasharray=\"9 3 1.5 3\"";
/// Deviation from the target above which the nearest profile that a material can have is drawn.
constexpr double min_drawn_bound = 0.01;

/// How much the envelope may extend the range of y on either side at most, as a fraction of the range of the curves.
constexpr double envelope_fraction = 0.35;

/// The range of the curves and, up to envelope_fraction, of the envelope.
Range range_of_y(const ProfilePlot& plot) {
  Range range;
  for (const auto* curve : {&plot.target, &plot.initial, &plot.achieved, &plot.bound, &plot.verified})
    range.add(*curve);
  range = widened(range);
  Range wide = range;
  wide.add(plot.lower);
  wide.add(plot.upper);
  const double max_extension = envelope_fraction * range.size();
  return {std::max(wide.low, range.low - max_extension), std::min(wide.high, range.high + max_extension)};
}

bool cover_half_turn(const ProfilePlot& plot) {
  if (!plot.polar || plot.x.size() < 3) return false;
  auto x = plot.x;
  std::sort(x.begin(), x.end());
  double gap = 0;
  for (std::size_t i = 1; i < x.size(); ++i) gap = std::max(gap, x[i] - x[i - 1]);
  return x.back() - x.front() < pi && x.front() + pi - x.back() <= 1.5 * gap;
}

std::string envelope_of(const ProfilePlot& plot, const Frame& frame) {
  if (plot.lower.empty()) return {};
  auto upper = curves_of(frame, plot.x, plot.upper);
  auto lower = curves_of(frame, plot.x, plot.lower);
  std::string path;
  for (std::size_t c = 0; c < upper.size(); ++c) {
    upper[c].straight = lower[c].straight = true;
    std::reverse(lower[c].points.begin(), lower[c].points.end());
    std::string back = path_of(lower[c]);
    // Two closed curves bound a ring. Open ones are joined: the lower one, reversed, closes the area.
    if (!frame.all_around && !back.empty()) back.front() = 'L';
    path += path_of(upper[c]) + (frame.all_around ? "Z" : "") + back + "Z";
  }
  return fmt::format("<path d=\"{}\" fill=\"{}\" fill-rule=\"evenodd\"/>\n", path, envelope_color);
}

/// Dots at the achieved values, hollow if the model was not trained on such states.
std::string dots_of(const ProfilePlot& plot, const Frame& frame) {
  std::string out;
  for (std::size_t i = 0; i < plot.achieved.size(); ++i) {
    const bool is_in_range = plot.in_range.empty() || plot.in_range[i];
    if (frame.polar && is_in_range) continue;
    for (int half = 0; half < (frame.polar ? 2 : 1); ++half)
      out += dot(frame.place(plot.x[i] + half * pi, plot.achieved[i]), 2.6, is_in_range ? achieved_color : "#ffffff",
                 achieved_color, 1.3);
  }
  return out;
}

std::string curves(const ProfilePlot& plot, const Frame& frame) {
  std::string out = stroke(path_of(frame, plot.x, plot.initial), initial_color, 1.6, " stroke-dasharray=\"5 4\"");
  out += stroke(path_of(frame, plot.x, plot.target), target_color, 7,
                " stroke-linecap=\"round\" stroke-linejoin=\"round\"");
  out += stroke(path_of(frame, plot.x, plot.bound), bound_color, 1.8, bound_dashes);
  out += stroke(path_of(frame, plot.x, plot.achieved), achieved_color, 2.2, " stroke-linejoin=\"round\"");
  out += dots_of(plot, frame);
  for (std::size_t i = 0; i < plot.verified.size(); ++i) {
    for (int half = 0; half < (frame.polar ? 2 : 1); ++half)
      out += dot(frame.place(plot.verified_x[i] + half * pi, plot.verified[i]), 4.4, "none", verified_color);
  }
  return out;
}

std::string legend(const ProfilePlot& plot, double y) {
  struct Entry {
    const char* name;
    bool shown;
    std::string sign;
  };
  const auto sample = [](const char* color, double width, const char* more = "") {
    return stroke("M0 0L24 0", color, width, more);
  };
  const bool outside = std::find(plot.in_range.begin(), plot.in_range.end(), false) != plot.in_range.end();
  const std::array<Entry, 6> entries{{
      {"target", !plot.target.empty(), sample(target_color, 7, " stroke-linecap=\"round\"")},
      {plot.achieved_name.c_str(), !plot.achieved.empty(), sample(achieved_color, 2.2)},
      {"initial", !plot.initial.empty(), sample(initial_color, 1.6, " stroke-dasharray=\"5 4\"")},
      {"simulated", !plot.verified.empty(), dot({12, 0}, 4.4, "none", verified_color)},
      {"outside of training", outside, dot({12, 0}, 2.6, "#ffffff", achieved_color, 1.3)},
      {"within reach", !plot.lower.empty(),
       fmt::format("<rect x=\"2\" y=\"-6\" width=\"20\" height=\"12\" fill=\"{}\" stroke=\"#d5dde8\"/>\n",
                   envelope_color)},
  }};
  std::string out;
  double x = margin_left;
  for (const auto& entry : entries) {
    if (!entry.shown) continue;
    out += fmt::format("<g transform=\"translate({:.1f} {:.1f})\">{}{}</g>\n", x, y, entry.sign,
                       text_at({31, 4}, entry.name, "start", 12, ink));
    x += 50 + 6.4 * static_cast<double>(std::string(entry.name).size());
  }
  // It has a line of its own, beside the circles of directions.
  if (!plot.bound.empty())
    out += fmt::format("<g transform=\"translate({:.1f} {:.1f})\">{}{}</g>\n", margin_left, y + legend_line_height,
                       sample(bound_color, 1.8, bound_dashes),
                       text_at({31, 4}, "nearest that any material can have at rest", "start", 12, ink));
  return out;
}

std::string area(const ProfilePlot& plot, std::size_t number) {
  Range x;
  x.add(plot.x);
  const Axes axes = plot.polar ? polar_axes(range_of_y(plot), cover_half_turn(plot))
                               : cartesian_axes(x, range_of_y(plot), plot.x_label, plot.y_label);
  const std::string clip = fmt::format("area-{}", number);
  const auto clipped = [&](const std::string& inside) {
    return fmt::format("<g clip-path=\"url(#{})\">\n{}</g>\n", clip, inside);
  };
  return fmt::format("<clipPath id=\"{}\">{}/></clipPath>\n", clip, axes.shape) +
         clipped(envelope_of(plot, axes.frame)) + axes.grid + clipped(curves(plot, axes.frame)) + axes.labels;
}

std::string panel(const ProfilePlot& plot, std::size_t number) {
  std::string out = text_at({margin_left, 28}, plot.title, "start", 16, ink, " font-weight=\"600\"");
  out += text_at({margin_left, 47}, plot.subtitle, "start", 12, faint_ink);
  out += legend(plot, 67);
  return out + area(plot, number);
}

std::string parameter_text(const nlohmann::json& values) {
  std::string text;
  for (const auto& value : values) text += fmt::format("{}{:.4g}", text.empty() ? "" : ", ", value.get<double>());
  return text;
}

/// A plot with what answers about designs and about profiles have in common.
ProfilePlot plot_of_kind(const nlohmann::json& profile) {
  const auto task = profile.at("task").get<std::string>();
  const bool green = profile.at("strain_measure") == "green";
  const char* const strain = green ? "Green strain" : "engineering strain";
  ProfilePlot plot;
  plot.polar = task != "stress_strain";
  plot.x = values_of(profile.at("x"));
  plot.in_range = profile.at("in_range").get<std::vector<bool>>();
  if (plot.polar) {
    plot.subtitle = fmt::format("{} over the direction of the load (rad), at {} {:.4g}",
                                task == "poisson" ? "Poisson\u2019s ratio" : "stiffness (MPa)", strain,
                                profile.at("strain").get<double>());
  } else {
    plot.x_label = strain;
    plot.y_label = green ? "second Piola-Kirchhoff stress (MPa)" : "force over rest width (MPa)";
    plot.subtitle = fmt::format("uniaxial load along {:.4g} rad, lateral strain and shear free",
                                profile.at("direction").get<double>());
  }
  return plot;
}

std::string design_text(const nlohmann::json& design) {
  return fmt::format("{} ({})", design.at("family").get<std::string>(), parameter_text(design.at("parameters")));
}

}  // namespace

std::vector<double> values_of(const nlohmann::json& array) {
  std::vector<double> values;
  for (const auto& value : array)
    values.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
  return values;
}

std::vector<ProfilePlot> plots_of_designs(const nlohmann::json& answer) {
  std::vector<ProfilePlot> plots;
  for (const auto& design : designs_in(answer)) {
    std::string title = design.contains("name") ? design.at("name").get<std::string>() + ": " : "";
    title += design_text(design);
    const auto& verdict = design.at("verdict");
    if (const auto& deviation = verdict.at("deviation"); deviation.is_number())
      title += fmt::format(", {} off by {:.2g} %", verdict.at("source") == "simulation" ? "simulated" : "by the model",
                           100 * deviation.get<double>());
    for (const auto& profile : profiles_in(design)) {
      ProfilePlot plot = plot_of_kind(profile);
      plot.title = title;
      plot.target = values_of(profile.at("target"));
      plot.initial = values_of(profile.at("initial"));
      plot.achieved = values_of(profile.at("achieved"));
      if (const auto& envelope = profile.at("envelope"); !envelope.is_null()) {
        plot.lower = values_of(envelope.at("lower"));
        plot.upper = values_of(envelope.at("upper"));
      }
      if (const auto bound = nearest_possible(profile); !bound.is_null() && bound.at("deviation") > min_drawn_bound)
        plot.bound = values_of(bound.at("y"));
      if (const auto& verified = profile.at("verified"); !verified.is_null()) {
        plot.verified_x = values_of(verified.at("x"));
        plot.verified = values_of(verified.at("y"));
      }
      plots.push_back(std::move(plot));
    }
  }
  return plots;
}

ProfilePlot plot_of_profile(const nlohmann::json& answer) {
  ProfilePlot plot = plot_of_kind(answer);
  plot.title = design_text(answer);
  plot.achieved_name = "neural model";
  plot.achieved = values_of(answer.at("y"));
  return plot;
}

std::string plot_svg(const std::vector<ProfilePlot>& plots) {
  const std::size_t columns = std::min(panels_per_row, std::max<std::size_t>(1, plots.size()));
  const std::size_t rows = (plots.size() + columns - 1) / columns;
  const double width = panel_width * static_cast<double>(columns);
  const double height = panel_height * static_cast<double>(rows);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} {1:g}\" "
      "font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\">\n"
      "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#ffffff\"/>\n",
      width, height);
  for (std::size_t i = 0; i < plots.size(); ++i) {
    const std::size_t row = i / columns;
    out +=
        fmt::format("<g transform=\"translate({:g} {:g})\">\n{}</g>\n", panel_width * static_cast<double>(i % columns),
                    panel_height * static_cast<double>(row), panel(plots[i], i));
  }
  return out + "</svg>\n";
}

}  // namespace supple::cli
