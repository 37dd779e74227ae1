#include "part_request.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "design_output.h"
#include "failure.h"
#include "numbers.h"
#include "style.h"

namespace supple::cli {
namespace {

/// Two lengths in mm, such as "20x60".
std::pair<double, double> parse_size(const std::string& text, const char* option) {
  const std::size_t cross = text.find('x');
  const auto first = numbers_in(std::string_view(text).substr(0, cross));
  const auto second = cross == std::string::npos ? std::nullopt : numbers_in(std::string_view(text).substr(cross + 1));
  if (!first || !second || first->size() != 1 || second->size() != 1)
    throw Failure(ExitCode::usage,
                  fmt::format("{}: '{}' is no size: write two lengths, for example 20x60 or 20mmx6cm", option, text));
  return {first->front(), second->front()};
}

/// Whether the part is a coupon or a block, which are loaded along y, or has an axis of its own.
bool has_load_axis(const nlohmann::json& request) {
  if (request.contains("axis")) return true;
  const auto outline = request.find("outline");
  return outline != request.end() && (outline->contains("coupon") || outline->contains("block"));
}

/// The direction along which a profile is loaded; null if it is over directions. Throws Failure(local_file) if a stress
/// over strain lacks it.
nlohmann::json direction_of(const nlohmann::json& profile, const std::string& source) {
  auto direction = profile.value("direction", nlohmann::json());
  if (direction.is_null() && profile.at("task") == "stress_strain")
    throw Failure(ExitCode::local_file,
                  fmt::format("{} lacks the direction of its load: say it by --direction, for example 0deg", source));
  return direction;
}

/// The only direction along which a design is loaded; null if its profiles are over directions or have several ones.
nlohmann::json load_direction(const nlohmann::json& design, const std::string& source) {
  nlohmann::json direction = direction_of(design.at("profile"), source);
  for (const auto& further : design.at("also")) {
    if (direction_of(further, source) != direction) return nullptr;
  }
  return direction;
}

void set_load_direction(const nlohmann::json& design, const std::string& source, nlohmann::json& request) {
  if (const auto direction = load_direction(design, source); !direction.is_null()) {
    request["direction"] = direction;
  } else {
    // Nothing is turned, so that the direction of the design along the part's axis is the axis itself.
    const auto axis = request.find("axis");
    const double tested = axis != request.end() && axis->is_number() ? axis->get<double>() : std::numbers::pi / 2;
    print_notice(fmt::format(
        "{} has no single direction of load: the part is loaded along its direction {:.4g}deg, unless supple "
        "part --direction says another one",
        source, 180 / std::numbers::pi * tested));
  }
}

/// The size of the structure of a coupon or a block, which has solid ends; empty for other outlines.
std::string size_between_ends(const nlohmann::json& outline) {
  const auto words = [](const nlohmann::json& shape, const char* length, const char* ends) {
    return fmt::format("; {:.6g} x {:.6g} mm between the {}", shape.at("width").get<double>(),
                       shape.at(length).get<double>(), ends);
  };
  if (outline.contains("coupon")) return words(outline.at("coupon"), "length", "grips");
  if (outline.contains("block")) return words(outline.at("block"), "height", "plates");
  return {};
}

/// Tells which direction of the design lies along the load, and how the structure was turned for that.
void print_load(const nlohmann::json& request, const nlohmann::json& answer) {
  const auto& direction = answer.at("tested_direction");
  if (direction.is_null()) return;
  constexpr double degrees = 180 / std::numbers::pi;
  const std::string axis = request.contains("axis") ? fmt::format("the part's axis of {:.4g} degrees",
                                                                  degrees * request["axis"].get<double>())
                                                    : "y";
  fmt::print("load     along the direction {:.6g} rad ({:.4g} degrees) of the design, which lies along {}\n",
             direction.get<double>(), degrees * direction.get<double>(), axis);
  const double turned = answer.at("orientation").get<double>() - request.value("orientation", 0.0);
  if (request.contains("direction") && std::abs(turned) > 1e-9) {
    fmt::print("         turned by {:.4g} degrees so that the design's load runs along the part\n", degrees * turned);
  }
}

}  // namespace

nlohmann::json outline_of_size(const std::string& kind, const std::string& size, const char* option) {
  const auto [width, height] = parse_size(size, option);
  if (kind == "rectangle") return {{kind, {width, height}}};
  return {{kind, {{"width", width}, {kind == "coupon" ? "length" : "height", height}}}};
}

nlohmann::json parse_sized_outline(const std::string& text, const char* option) {
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  if (colon == std::string::npos || (kind != "coupon" && kind != "block" && kind != "rectangle"))
    throw Failure(ExitCode::usage, fmt::format("{}: '{}' is no part: write coupon:20x60, block:30x20 or "
                                               "rectangle:40x120, with lengths in mm or with a unit",
                                               option, text));
  return outline_of_size(kind, text.substr(colon + 1), option);
}

void use_design(const nlohmann::json& design, const std::string& source, nlohmann::json& request) {
  if (design.contains("regions"))
    throw Failure(ExitCode::local_file,
                  fmt::format("{} holds the designs of several regions: a part takes a single one", source));
  try {
    request["structure"] = {{"family", design.at("family")}, {"parameters", design.at("parameters")}};
    request["beam_width"] = design.at("structure").at("beam_width");
    request["orientation"] = design.at("orientation");
    request["material"] = {{"density", design.at("material").at("density")}};
    if (has_load_axis(request) && !request.contains("direction")) set_load_direction(design, source, request);
  } catch (const nlohmann::json::exception&) {
    throw Failure(ExitCode::local_file, fmt::format("{} holds no design: write one by supple design --json", source));
  }
}

bool write_part(Session& session, const nlohmann::json& request, const PartFiles& files) {
  bool on_terminal = false;
  for (const auto& [file, media_type] : {std::pair(&files.stl, "model/stl"), std::pair(&files.three_mf, "model/3mf"),
                                         std::pair(&files.step, "model/step"), std::pair(&files.dxf, "image/vnd.dxf"),
                                         std::pair(&files.svg, "image/svg+xml")}) {
    if (file->empty()) continue;
    write_file(*file, session.compute("/v1/parts", request, media_type).body);
    on_terminal |= *file == "-";
  }
  return on_terminal;
}

PartFiles numbered_files(const PartFiles& files, std::size_t index, std::size_t count) {
  const auto numbered = [&](const std::string& file) {
    return file.empty() ? file : numbered_file(file, index, count);
  };
  return {numbered(files.step), numbered(files.stl), numbered(files.three_mf), numbered(files.dxf),
          numbered(files.svg)};
}

void print_part(const nlohmann::json& request, const nlohmann::json& answer) {
  const auto number = [&answer](const char* name) { return answer.at(name).get<double>(); };
  const auto& size = answer.at("size");
  const auto& checks = answer.at("checks");
  fmt::print("size     {:.6g} x {:.6g} x {:.6g} mm{}\n", size.at(0).get<double>(), size.at(1).get<double>(),
             size.at(2).get<double>(), size_between_ends(request.at("outline")));
  fmt::print("solid    {:.6g} mm^2, {:.3g} of the outline\n", number("solid_area"), number("relative_density"));
  fmt::print("mass     {:.4g} g, {:.6g} mm^3\n", number("mass"), number("volume"));
  fmt::print("walls    {:.3g} mm^2 narrower than {:.3g} mm were left out\n", checks.at("trimmed_area").get<double>(),
             checks.at("smallest_wall").get<double>());
  const auto& neck = checks.at("smallest_neck");
  fmt::print("necks    {}; {} were widened, {} cut\n",
             neck.is_null() ? "none" : fmt::format("at least {:.3g} mm", neck.get<double>()),
             checks.at("widened_necks").get<int>(), checks.at("cut_necks").get<int>());
  print_load(request, answer);
  fmt::print("pieces   one; {} without connection to it were left out\n", checks.at("crumbs").get<int>());
  const auto message = answer.at("message").get<std::string>();
  if (!message.empty()) fmt::print("note     {}\n", message);
}

}  // namespace supple::cli
