#include "supple/access/duration.h"

#include <array>
#include <charconv>
#include <ctime>
#include <stdexcept>
#include <utility>

namespace supple::access {
namespace {

constexpr const char* time_form = "%Y-%m-%dT%H:%M:%SZ";
constexpr std::array<std::pair<char, std::int64_t>, 4> units{{{'d', 86400}, {'h', 3600}, {'m', 60}, {'s', 1}}};
constexpr std::int64_t max_seconds = 100LL * 366 * 86400;  // small enough that adding it to a time does not overflow

}  // namespace

std::int64_t parse_duration(std::string_view text) {
  for (const auto& [unit, seconds] : units) {
    if (!text.ends_with(unit)) continue;
    std::int64_t number = 0;
    const auto* const end = text.data() + text.size() - 1;
    const auto [number_end, error] = std::from_chars(text.data(), end, number);
    if (error == std::errc() && number_end == end && number > 0 && number <= max_seconds / seconds)
      return number * seconds;
  }
  throw std::runtime_error("'" + std::string(text) +
                           "' is no duration of up to 100 years; write it as 90d, 24h, 30m or 45s");
}

std::string time_text(std::int64_t seconds) {
  const auto time = static_cast<std::time_t>(seconds);
  std::tm parts{};
  gmtime_r(&time, &parts);
  std::array<char, 40> text{};
  return {text.data(), std::strftime(text.data(), text.size(), time_form, &parts)};
}

std::int64_t parse_time(const std::string& text) {
  std::tm parts{};
  const char* const end = strptime(text.c_str(), time_form, &parts);
  if (!end || *end != '\0') throw std::runtime_error("'" + text + "' is no time such as 2026-01-31T23:59:59Z");
  return timegm(&parts);
}

}  // namespace supple::access
