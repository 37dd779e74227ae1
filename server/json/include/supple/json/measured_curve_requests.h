#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "supple/base/cancellation.h"
#include "supple/design/measurements.h"
#include "supple/json/limits.h"
#include "supple/json/name_table.h"

/// Measured curves that become targets; the request is read like those of requests.h and throws the same. Whether the
/// text is a table, and its units are known, is not checked here.
namespace supple::json {

/// The senses that a request may ask for; an answer may also have "both".
inline constexpr auto sense_names = names_of<design::Sense>({{design::Sense::automatic, "automatic"},
                                                             {design::Sense::tension, "tension"},
                                                             {design::Sense::compression, "compression"}});
inline constexpr auto zero_names = names_of<design::ZeroChoice>({{design::ZeroChoice::automatic, "automatic"},
                                                                 {design::ZeroChoice::first, "first"},
                                                                 {design::ZeroChoice::as_written, "as_written"}});
/// The character that separates decimals; 0 where it is found out.
inline constexpr auto decimal_separator_names = names_of<char>({{'\0', "automatic"}, {'.', "point"}, {',', "comma"}});

struct MeasuredCurveRequest {
  design::MeasurementRequest measurements;  ///< measurements with the text of "text", or of "content" in UTF-8
  std::string encoding = "utf-8";           ///< encoding of "content"
  const char* text_field = "/text";         ///< pointer to the field that the text comes from
  design::ReductionOptions options;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
MeasuredCurveRequest parse_measured_curve(std::string_view body, const Limits& limits,
                                          const CancellationToken& cancellation = {});

}  // namespace supple::json
