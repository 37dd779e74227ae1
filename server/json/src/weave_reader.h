#pragma once

#include "request_parts.h"
#include "supple/json/weave_requests.h"

// What requests about weaves have in common.
namespace supple::json {

/// The required field "weave".
WeaveSpec read_weave(Fields& fields, const Limits& limits);

/// The optional fields "accuracy", "sliding" and "effects".
void read_equilibrium_options(Fields& fields, weave::EquilibriumOptions& options);

}  // namespace supple::json
