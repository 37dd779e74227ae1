#include <cstdio>
#include <ctime>

#include "supple/json/answers.h"

namespace supple::json {

std::string time_text(std::int64_t milliseconds) {
  const std::time_t whole = milliseconds / 1000;
  std::tm parts{};
  gmtime_r(&whole, &parts);
  char text[80];
  const int length =
      std::snprintf(text, sizeof text, "%04d-%02d-%02dT%02d:%02d:%02d.%03dZ", parts.tm_year + 1900, parts.tm_mon + 1,
                    parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec, static_cast<int>(milliseconds % 1000));
  return {text, static_cast<std::size_t>(length)};
}

}  // namespace supple::json
