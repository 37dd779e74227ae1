#include "surface_point.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "failure.h"

namespace supple::cli {
namespace {

/// The number that all of `part` is, or nothing.
template <class Number>
std::optional<Number> number_in(std::string_view part) {
  Number value{};
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
  if (error != std::errc{} || end != part.data() + part.size()) return std::nullopt;
  return value;
}

/// The numbers between the commas; nothing where one of them is none or not finite.
std::optional<std::vector<double>> numbers_in(std::string_view text) {
  std::vector<double> values;
  while (true) {
    const std::size_t comma = text.find(',');
    const auto value = number_in<double>(text.substr(0, comma));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    values.push_back(*value);
    if (comma == std::string_view::npos) return values;
    text.remove_prefix(comma + 1);
  }
}

[[noreturn]] void reject(const std::string& text) {
  throw Failure(ExitCode::usage,
                fmt::format("'{}' is not a surface point: write v17 for a vertex, or 12:0.2,0.3,0.5 for a face and its "
                            "barycentric coordinates",
                            text));
}

std::int64_t read_index(std::string_view part, const std::string& whole) {
  const auto index = number_in<std::int64_t>(part);
  if (!index || *index < 0) reject(whole);
  return *index;
}

}  // namespace

nlohmann::json parse_surface_point(const std::string& text) {
  const std::string_view view = text;
  if (view.starts_with('v')) return {{"vertex", read_index(view.substr(1), text)}};
  const std::size_t colon = view.find(':');
  if (colon == std::string_view::npos) reject(text);
  auto barycentric = numbers_in(view.substr(colon + 1));
  if (!barycentric || barycentric->size() < 2 || barycentric->size() > 3) reject(text);
  if (barycentric->size() == 2) barycentric->push_back(1 - (*barycentric)[0] - (*barycentric)[1]);
  return {{"face", read_index(view.substr(0, colon), text)}, {"barycentric", *barycentric}};
}

std::vector<double> parse_numbers(const std::string& text, const char* what) {
  auto numbers = numbers_in(text);
  if (!numbers) {
    throw Failure(ExitCode::usage, fmt::format("'{}' is no {}: write numbers separated by commas", text, what));
  }
  return *std::move(numbers);
}

std::string describe_surface_point(const nlohmann::json& point) {
  if (point.contains("vertex")) return fmt::format("vertex {}", point.at("vertex").get<std::int64_t>());
  const auto& b = point.at("barycentric");
  return fmt::format("face {} ({:.9g}, {:.9g}, {:.9g})", point.at("face").get<std::int64_t>(), b.at(0).get<double>(),
                     b.at(1).get<double>(), b.at(2).get<double>());
}

}  // namespace supple::cli
