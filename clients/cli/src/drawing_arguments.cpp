#include "drawing_arguments.h"

#include <fmt/format.h>
#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <set>
#include <utility>

#include "angles.h"
#include "failure.h"
#include "numbers.h"
#include "units.h"

namespace supple::cli {
namespace {

/// Longer lists of names end with "...".
constexpr std::size_t max_listed_names = 12;

bool is_called(const nlohmann::json& polygon, const std::string& name) {
  const auto& names = polygon.at("names");
  return std::any_of(names.begin(), names.end(), [&name](const auto& own) { return own == name; });
}

std::string known_names(const nlohmann::json& drawing) {
  std::set<std::string> names;
  for (const auto& polygon : drawing.at("polygons")) {
    for (const auto& name : polygon.at("names")) names.insert(name.get<std::string>());
  }
  if (names.empty()) return "its curves have no names";
  std::string words = "its names are ";
  std::size_t listed = 0;
  for (const std::string& name : names) {
    if (listed == max_listed_names) return words + ", ...";
    if (listed > 0) words += ", ";
    words += name;
    ++listed;
  }
  return words;
}

bool is_utf8(const std::string& bytes) {
  std::size_t at = 0;
  while (at < bytes.size()) {
    const auto lead = static_cast<unsigned char>(bytes[at]);
    const std::size_t continuation_bytes = lead < 0x80                   ? 0
                                           : lead >= 0xC2 && lead < 0xE0 ? 1
                                           : lead >= 0xE0 && lead < 0xF0 ? 2
                                           : lead >= 0xF0 && lead < 0xF5 ? 3
                                                                         : 4;
    if (continuation_bytes == 4 || at + continuation_bytes >= bytes.size() + (continuation_bytes == 0 ? 1 : 0))
      return false;
    for (std::size_t k = 1; k <= continuation_bytes; ++k) {
      if ((static_cast<unsigned char>(bytes[at + k]) & 0xC0U) != 0x80U) return false;
    }
    at += continuation_bytes + 1;
  }
  return true;
}

/// The indices of the polygons with this name. Throws Failure(usage) if there are none.
std::vector<std::size_t> polygons_named(const nlohmann::json& drawing, const std::string& name, const char* option) {
  std::vector<std::size_t> found;
  const auto& polygons = drawing.at("polygons");
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    if (is_called(polygons[i], name)) found.push_back(i);
  }
  if (found.empty()) {
    throw Failure(ExitCode::usage,
                  fmt::format("{}: the drawing has no closed curve '{}'; {}", option, name, known_names(drawing)));
  }
  return found;
}

/// A region without its outline, from NAME=FAMILY[,WIDTH[,ANGLE]].
nlohmann::json region_of(const std::string& text) {
  const auto equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    throw Failure(ExitCode::usage,
                  fmt::format("--region: '{}' is no region: write NAME=FAMILY, for example heel=IH29,0.5", text));
  }
  std::vector<std::string> words;
  std::string rest = text.substr(equals + 1);
  for (std::size_t comma = rest.find(','); comma != std::string::npos; comma = rest.find(',')) {
    words.push_back(rest.substr(0, comma));
    rest.erase(0, comma + 1);
  }
  words.push_back(rest);
  if (words.size() > 3) {
    throw Failure(ExitCode::usage,
                  fmt::format("--region: '{}' has more than a family, a width of beams and an angle", text));
  }
  nlohmann::json region = {{"name", text.substr(0, equals)}, {"structure", {{"family", words[0]}}}};
  if (words.size() > 1)
    region["beam_width"] =
        parse_number(in_base_units(words[1], Dimension::length, "--region"), "width of beams of --region");
  if (words.size() > 2) region["orientation"] = parse_angle(words[2], "--region");
  return region;
}

/// The text of a drawing as UTF-8; bytes that are no character of its character set become '?'. Empty if the character
/// set is unknown.
std::string utf8_of(const std::string& bytes, const std::string& character_set) {
  const iconv_t converter = iconv_open("UTF-8", character_set.c_str());
  // iconv_open returns -1 if it does not know a character set.
  if (converter == reinterpret_cast<iconv_t>(-1)) return {};  // NOLINT(performance-no-int-to-ptr)
  std::string source = bytes, result;
  char* in = source.data();
  std::size_t remaining_bytes = source.size();
  std::array<char, 4096> buffer{};
  while (remaining_bytes > 0) {
    char* out = buffer.data();
    std::size_t free_bytes = buffer.size();
    const bool failed = iconv(converter, &in, &remaining_bytes, &out, &free_bytes) == static_cast<std::size_t>(-1);
    result.append(buffer.data(), buffer.size() - free_bytes);
    if (!failed || errno == E2BIG) continue;
    result += '?';
    ++in;
    --remaining_bytes;
  }
  iconv_close(converter);
  return result;
}

/// The code page of a file that is not UTF-8. DXF files before 2007 name it, such as "ANSI_1252"; it is also the
/// default.
std::string code_page_of(const std::string& bytes) {
  constexpr std::string_view default_code_page = "CP1252";
  const auto at = bytes.find("$DWGCODEPAGE");
  if (at == std::string::npos) return std::string(default_code_page);
  const auto end_of_line = bytes.find('\n', bytes.find('\n', at) + 1);
  if (end_of_line == std::string::npos) return std::string(default_code_page);
  const std::string value =
      bytes.substr(end_of_line + 1, bytes.find_first_of("\r\n", end_of_line + 1) - end_of_line - 1);
  const auto digits = value.find_first_of("0123456789");
  return digits == std::string::npos ? std::string(default_code_page) : "CP" + value.substr(digits);
}

std::string text_of_drawing(const std::string& file) {
  std::string bytes = file != "-"
                          ? read_file(file)
                          : std::string(std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>());
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) return utf8_of(bytes, "UTF-16");
  if (is_utf8(bytes)) return bytes;
  const std::string text = utf8_of(bytes, code_page_of(bytes));
  return text.empty() ? utf8_of(bytes, "ISO-8859-1") : text;
}

}  // namespace

void add_drawing_options(CLI::App& command, DrawingArguments& arguments) {
  command.add_option("--unit", arguments.unit, "What one unit of the drawing is (what the file says)")
      ->check(CLI::IsMember({"mm", "cm", "m", "in", "ft", "pt", "px"}));
  command
      .add_option("--resolution", arguments.resolution, "Pixels per inch of an SVG file without a physical size (96)")
      ->check(CLI::PositiveNumber);
  command.add_option("--width", arguments.width, "Scale the drawing until its closed curves are so wide, mm")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber);
  command.add_option("--tolerance", arguments.tolerance, "Distance of a chord from its curve at most, mm (0.05)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber);
}

nlohmann::json read_drawing(Session& session, const std::string& file, const DrawingArguments& arguments) {
  nlohmann::json request = {{"text", text_of_drawing(file)}};
  if (!arguments.unit.empty()) request["unit"] = arguments.unit;
  if (arguments.resolution > 0) request["resolution"] = arguments.resolution;
  if (arguments.width > 0) request["width"] = arguments.width;
  if (arguments.tolerance > 0) request["accuracy"] = {{"tolerance", arguments.tolerance}};
  nlohmann::json answer = session.compute("/v1/outlines", request).json();
  for (const auto& warning : answer.at("warnings"))
    fmt::print(stderr, "supple: {}: {}\n", file, warning.get<std::string>());
  return answer;
}

DrawingChoice drawing_choice(const std::string& text) {
  const auto hash = text.rfind('#');
  std::error_code ignored;
  if (hash == std::string::npos || std::filesystem::exists(text, ignored)) return {text, {}};
  return {text.substr(0, hash), text.substr(hash + 1)};
}

void use_drawing(const nlohmann::json& drawing, const std::string& outline_name,
                 const std::vector<std::string>& regions, nlohmann::json& request) {
  const auto& polygons = drawing.at("polygons");
  std::vector<bool> is_region(polygons.size(), false);
  nlohmann::json filled = nlohmann::json::array();
  for (const std::string& text : regions) {
    nlohmann::json region = region_of(text);
    for (const std::size_t i : polygons_named(drawing, region.at("name").get<std::string>(), "--region")) {
      is_region[i] = true;
      region["outline"] = polygons[i].at("points");
      filled.push_back(region);
    }
  }
  nlohmann::json outline = nlohmann::json::array();
  if (!outline_name.empty()) {
    for (const std::size_t i : polygons_named(drawing, outline_name, "--outline"))
      outline.push_back(polygons[i].at("points"));
  } else {
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      if (!is_region[i]) outline.push_back(polygons[i].at("points"));
    }
  }
  // Where every closed curve is a region, the part is their union.
  request["outline"] = outline.empty() ? nlohmann::json{{"regions", true}} : nlohmann::json{{"polygons", outline}};
  if (outline.empty() && !request.contains("structure")) request["structure"] = filled.at(0).at("structure");
  if (!filled.empty()) request["regions"] = filled;
}

}  // namespace supple::cli
