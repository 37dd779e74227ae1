#include "surface_point.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include "failure.h"

namespace supple::cli {
namespace {

[[noreturn]] void reject(const std::string& text) {
  throw Failure(ExitCode::usage,
                fmt::format("'{}' is not a surface point: write v17 for a vertex, or 12:0.2,0.3,0.5 for a face and its "
                            "barycentric coordinates",
                            text));
}

template <class Number>
Number read_number(std::string_view part, const std::string& whole) {
  Number value{};
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
  if (error != std::errc{} || end != part.data() + part.size()) reject(whole);
  return value;
}

}  // namespace

nlohmann::json parse_surface_point(const std::string& text) {
  std::string_view rest = text;
  if (rest.starts_with('v')) return {{"vertex", read_number<std::int64_t>(rest.substr(1), text)}};
  const std::size_t colon = rest.find(':');
  if (colon == std::string_view::npos) reject(text);
  const auto face = read_number<std::int64_t>(rest.substr(0, colon), text);
  rest.remove_prefix(colon + 1);
  std::vector<double> barycentric;
  while (true) {
    const std::size_t comma = rest.find(',');
    const auto value = read_number<double>(rest.substr(0, comma), text);
    if (!std::isfinite(value)) reject(text);
    barycentric.push_back(value);
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (barycentric.size() == 2) barycentric.push_back(1 - barycentric[0] - barycentric[1]);
  if (barycentric.size() != 3) reject(text);
  return {{"face", face}, {"barycentric", barycentric}};
}

std::string describe_surface_point(const nlohmann::json& point) {
  if (point.contains("vertex")) return fmt::format("vertex {}", point.at("vertex").get<std::int64_t>());
  const auto& b = point.at("barycentric");
  return fmt::format("face {} ({:.9g}, {:.9g}, {:.9g})", point.at("face").get<std::int64_t>(), b.at(0).get<double>(),
                     b.at(1).get<double>(), b.at(2).get<double>());
}

}  // namespace supple::cli
