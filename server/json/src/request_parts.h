#pragma once

#include <string_view>
#include <vector>

#include "fields.h"
#include "supple/json/limits.h"

// What several requests have in common.
namespace supple::json {

/// The values of an effect's switch, in the order of the enumerations that stand for them.
inline const std::vector<std::string_view> switch_names{"automatic", "on", "off"};

/// The field "deadline" in seconds, or its default. Throws "request.limit_exceeded".
double read_deadline(Fields& fields, const Limits& limits);

/// Calls read(fields) for an optional nested object.
template <class Read>
void nested(Fields& fields, std::string_view name, Read read) {
  const auto* value = fields.optional(name);
  if (!value) return;
  Fields inner(*value, fields.at(name), fields.faults());
  read(inner);
  inner.finish();
}

}  // namespace supple::json
