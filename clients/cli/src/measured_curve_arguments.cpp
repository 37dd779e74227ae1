#include "measured_curve_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <string_view>
#include <utility>

#include "failure.h"
#include "load_arguments.h"
#include "numbers.h"
#include "style.h"
#include "units.h"

namespace supple::cli {
namespace {

constexpr int max_control_points = 64;
constexpr int max_blocks = 10'000;

/// Whether a text is valid UTF-8, as JSON requires: without overlong forms and without surrogates.
bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    const unsigned char first = byte(i);
    const std::size_t length = first < 0x80                    ? 1
                               : first >= 0xC2 && first < 0xE0 ? 2
                               : first >= 0xE0 && first < 0xF0 ? 3
                               : first >= 0xF0 && first < 0xF5 ? 4
                                                               : 0;
    if (length == 0 || i + length > text.size()) return false;
    for (std::size_t k = 1; k < length; ++k) {
      if ((byte(i + k) & 0xC0) != 0x80) return false;
    }
    if ((first == 0xE0 && byte(i + 1) < 0xA0) || (first == 0xED && byte(i + 1) >= 0xA0)) return false;
    if ((first == 0xF0 && byte(i + 1) < 0x90) || (first == 0xF4 && byte(i + 1) >= 0x90)) return false;
    i += length;
  }
  return true;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = (bits << 8) | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += k <= count ? alphabet[(bits >> (18 - 6 * k)) & 0x3F] : '=';
  }
  return out;
}

/// Two entries separated by a comma, either of which may be empty.
std::pair<std::string, std::string> parse_two_texts(const std::string& text, const char* option) {
  const auto comma = text.find(',');
  if (comma == std::string::npos || text.find(',', comma + 1) != std::string::npos)
    throw Failure(ExitCode::usage,
                  fmt::format("{} takes two entries separated by a comma, one for x and one for y", option));
  return {text.substr(0, comma), text.substr(comma + 1)};
}

nlohmann::json column_of(const std::string& text) {
  if (const auto index = integer_in(text)) return *index;
  return text;
}

}  // namespace

void add_measured_curve_options(CLI::App& command, MeasuredCurveArguments& arguments) {
  command.add_option("--columns", arguments.columns,
                     "Columns x,y of a measured file, by index from 0 or by name (told by the header)");
  command.add_option("--units", arguments.units,
                     "Units x,y of a measured file, for example %,kPa or mm,N (the header's)");
  command
      .add_option("--gauge-length", arguments.gauge_length, "Length at rest that was stretched in mm; of displacements")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber);
  command.add_option("--area", arguments.area, "Cross-section at rest in mm^2; of forces")
      ->transform(quantity(Dimension::area))
      ->check(CLI::PositiveNumber);
  command
      .add_option("--sense", arguments.sense,
                  "What was measured: tension or compression (told by signs, titles or remarks; else tension)")
      ->check(CLI::IsMember({"automatic", "tension", "compression"}));
  command
      .add_option("--decimal-separator", arguments.decimal_separator,
                  "Of a measured file's numbers (told by all of them)")
      ->check(CLI::IsMember({"automatic", "point", "comma"}));
  command
      .add_option(
          "--zero", arguments.zero,
          "Where displacements count from: first, the first one, or as_written, zero (zero, if they begin there)")
      ->check(CLI::IsMember({"automatic", "first", "as_written"}));
  command.add_option("--block", arguments.block, "Which of several blocks of rows is read, from 0 (the first)")
      ->check(CLI::Range(0, max_blocks - 1));
  const auto switches = CLI::IsMember({"automatic", "on", "off"});
  command
      .add_option("--loading", arguments.loading,
                  "Whether only first loadings of a measured file count (automatic: where the strain turns back)")
      ->check(switches);
  command
      .add_option(
          "--rupture", arguments.rupture,
          "Whether what follows a break of the specimen is left out (automatic: where the stress falls suddenly)")
      ->check(switches);
  command
      .add_option("--origin", arguments.origin,
                  "Whether the measured curve passes through zero (automatic: where it begins near it)")
      ->check(switches);
  command.add_option("--control-points", arguments.control_points, "Control points of a measured curve, at most (12)")
      ->check(CLI::Range(2, max_control_points));
}

bool is_measured(const std::string& target) {
  std::error_code ignored;
  return target == "-" || std::filesystem::is_regular_file(target, ignored) || looks_like_path(target);
}

std::string bytes_of_measurements(const std::string& file) {
  if (file != "-") return read_file(file);
  return {std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>()};
}

nlohmann::json reduce_curve(Session& session, const std::string& bytes, const std::string& task,
                            const MeasuredCurveArguments& arguments) {
  nlohmann::json request;
  // The server recognizes other encodings, but JSON can contain only UTF-8, so other bytes are sent as base64.
  if (is_utf8(bytes) && bytes.find('\0') == std::string::npos) {
    request["text"] = bytes;
  } else {
    request["content"] = base64(bytes);
  }
  if (!task.empty()) request["task"] = task;
  if (!arguments.columns.empty()) {
    const auto [x, y] = parse_two_texts(arguments.columns, "--columns");
    if (!x.empty()) request["columns"]["x"] = column_of(x);
    if (!y.empty()) request["columns"]["y"] = column_of(y);
  }
  if (!arguments.units.empty()) {
    const auto [x, y] = parse_two_texts(arguments.units, "--units");
    if (!x.empty()) request["units"]["x"] = x;
    if (!y.empty()) request["units"]["y"] = y;
  }
  if (arguments.gauge_length > 0) request["specimen"]["gauge_length"] = arguments.gauge_length;
  if (arguments.area > 0) request["specimen"]["area"] = arguments.area;
  const auto set_text = [&](const char* name, const std::string& value) {
    if (!value.empty()) request[name] = value;
  };
  set_text("sense", arguments.sense);
  set_text("decimal_separator", arguments.decimal_separator);
  set_text("zero", arguments.zero);
  if (arguments.block >= 0) request["block"] = arguments.block;
  const auto set_effect = [&](const char* name, const std::string& value) {
    if (!value.empty()) request["effects"][name] = value;
  };
  set_effect("origin", arguments.origin);
  set_effect("loading", arguments.loading);
  set_effect("rupture", arguments.rupture);
  if (arguments.control_points > 0) request["accuracy"]["max_control_points"] = arguments.control_points;
  return session.compute("/v1/measured-curves", request).json();
}

std::string reduction_words(const nlohmann::json& answer) {
  return fmt::format("{} control points follow {} measured ones within {:.2g} %",
                     answer.at("target").at("control_points").size(), answer.at("point_count").get<std::size_t>(),
                     100 * answer.at("error").at("relative_rms").get<double>());
}

void print_curve_notes(const nlohmann::json& answer) {
  for (const auto& note : answer.at("notes")) {
    const auto text = note.at("text").get<std::string>();
    const bool is_warning = note.at("level").get<std::string>() == "warning";
    fmt::print(stderr, "{}\n", is_warning ? styled("Warning: " + text, Style::warning, stderr) : text);
  }
}

}  // namespace supple::cli
