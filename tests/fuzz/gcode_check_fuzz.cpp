// Feeds arbitrary bytes to the checker of G-code. Its report must have finite numbers, existing lines and printable
// messages, and must be the same when it is made again.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "supple/weave/gcode_check.h"

namespace {

using supple::weave::FoundChannel;
using supple::weave::GcodeReport;
using supple::weave::Violation;

void require(bool condition) {
  if (!condition) std::abort();
}

void check_violations(const GcodeReport& report) {
  require(static_cast<int>(report.violations.size()) <= report.violation_count);
  int last = 1;
  for (const Violation& violation : report.violations) {
    require(violation.line >= last && violation.line <= report.lines);
    last = violation.line;
    require(!violation.message.empty() && !to_string(violation.kind).empty());
    for (const char c : violation.message) require(c >= ' ' && c <= '~');
  }
}

void check_unchecked(const GcodeReport& report) {
  require(static_cast<int>(report.unchecked.size()) <= report.unchecked_count);
  for (const auto& command : report.unchecked) {
    require(command.line >= 1 && command.line <= report.lines && !command.command.empty());
    for (const char c : command.command) require(c > ' ' && c <= '~');
  }
}

void check_numbers(const GcodeReport& report) {
  for (const double number :
       {report.extruded_length, report.filament, report.travel_length, report.minutes, report.channel_length})
    require(std::isfinite(number) && number >= 0);
  require(report.lowest.allFinite() && report.highest.allFinite());
  require((report.highest - report.lowest).minCoeff() >= 0);
  require(report.travels >= 0 && report.retractions >= 0 && report.channel_length <= report.extruded_length * 1.000001);
  for (std::size_t i = 1; i < report.heights.size(); ++i) require(report.heights[i] > report.heights[i - 1]);
  for (const FoundChannel& channel : report.channels) {
    require(channel.line >= 1 && channel.line <= report.lines);
    require(channel.apex[2] > channel.start[2] && channel.apex[2] > channel.end[2]);
    require(channel.length > 0);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const GcodeReport report = supple::weave::check_gcode(bytes);
  check_violations(report);
  check_unchecked(report);
  check_numbers(report);
  const GcodeReport again = supple::weave::check_gcode(bytes);
  require(again.violation_count == report.violation_count && again.channels.size() == report.channels.size());
  return 0;
}
