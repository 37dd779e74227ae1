#include "request_parts.h"

#include <algorithm>
#include <limits>

#include "supple/problem/problem.h"

namespace supple::json {

double read_deadline(Fields& fields, const Limits& limits) {
  double deadline = std::min(limits.default_deadline, limits.max_deadline);
  fields.number("deadline", deadline, 0, std::numeric_limits<double>::max(), true);
  if (deadline > limits.max_deadline) {
    problem::throw_limit("request.limit_exceeded", "The deadline in seconds", limits.max_deadline, deadline,
                         "--max-deadline", fields.at("deadline"));
  }
  return deadline;
}

}  // namespace supple::json
