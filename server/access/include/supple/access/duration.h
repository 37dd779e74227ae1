#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace supple::access {

/// The duration "90d", "24h", "30m" or "45s" in seconds. Throws std::runtime_error for text of another form and for
/// more than 100 years.
std::int64_t parse_duration(std::string_view text);

/// The time "2026-01-31T23:59:59Z" (UTC) of a number of seconds since 1970.
std::string time_text(std::int64_t seconds);
/// The inverse of `time_text`. Throws std::runtime_error for text of another form.
std::int64_t parse_time(const std::string& text);

}  // namespace supple::access
