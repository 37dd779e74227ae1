#include "numbers.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <utility>

#include "failure.h"

namespace supple::cli {
namespace {

/// A longer series is a typing error, since no server accepts so many numbers.
constexpr std::int64_t max_series_length = 1'000'000;

template <class Number>
std::optional<Number> number_in(std::string_view part) {
  Number value{};
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
  if (error != std::errc{} || end != part.data() + part.size()) return std::nullopt;
  return value;
}

std::optional<std::vector<double>> spaced_numbers_in(std::string_view text) {
  const std::size_t first_colon = text.find(':');
  const std::size_t second_colon = text.find(':', first_colon + 1);
  if (second_colon == std::string_view::npos) return std::nullopt;
  const auto first = number_in<double>(text.substr(0, first_colon));
  const auto last = number_in<double>(text.substr(first_colon + 1, second_colon - first_colon - 1));
  const auto count = number_in<std::int64_t>(text.substr(second_colon + 1));
  if (!first || !last || !count || !std::isfinite(*first) || !std::isfinite(*last)) return std::nullopt;
  if (*count < 2 || *count > max_series_length) return std::nullopt;
  std::vector<double> values;
  for (std::int64_t i = 0; i < *count; ++i) {
    const double fraction = static_cast<double>(i) / static_cast<double>(*count - 1);
    values.push_back((1 - fraction) * *first + fraction * *last);
  }
  return values;
}

}  // namespace

std::int64_t index_of(double number, const std::string& text, const char* what) {
  if (number < 0 || number != std::floor(number) || number > 2147483647.0)
    throw Failure(ExitCode::usage, fmt::format("'{}' names no {} by its index", text, what));
  return static_cast<std::int64_t>(number);
}

std::vector<std::int64_t> parse_indices(const std::string& text, const char* what) {
  std::vector<std::int64_t> indices;
  for (const double number : parse_numbers(text, "list of indices")) indices.push_back(index_of(number, text, what));
  return indices;
}

std::optional<std::int64_t> integer_in(std::string_view text) { return number_in<std::int64_t>(text); }

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

std::vector<double> parse_numbers(const std::string& text, const char* what) {
  auto numbers = numbers_in(text);
  if (!numbers) {
    throw Failure(ExitCode::usage, fmt::format("'{}' is no {}: write numbers separated by commas", text, what));
  }
  return *std::move(numbers);
}

double parse_number(const std::string& text, const char* what) {
  const auto numbers = numbers_in(text);
  if (!numbers || numbers->size() != 1) throw Failure(ExitCode::usage, fmt::format("'{}' is no {}", text, what));
  return numbers->front();
}

std::vector<double> parse_series(const std::string& text, const char* what) {
  auto numbers = text.find(':') == std::string::npos ? numbers_in(text) : spaced_numbers_in(text);
  if (!numbers) {
    throw Failure(
        ExitCode::usage,
        fmt::format("'{}' is no {}: write numbers separated by commas, or first:last:n for n of them (2 or more)", text,
                    what));
  }
  return *std::move(numbers);
}

}  // namespace supple::cli
