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
                         limits.deadline_setting, fields.at("deadline"));
  }
  return deadline;
}

void check_priority(Fields& fields) {
  auto priority = Priority::normal;
  fields.choice("priority", priority, priority_name_table);
}

bool is_builder(Fields& fields, std::string_view name) {
  const auto* value = fields.optional(name);
  return value && value->is_object();
}

void read_indices(Fields& fields, std::string_view name, const Limits& limits, std::vector<std::int32_t>& indices) {
  const auto* entries = fields.array(name, false, 0, limits.max_points, "--max-points");
  if (!entries) return;
  indices.reserve(entries->size());
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const auto at = fields.at(name) + "/" + std::to_string(i);
    indices.push_back(read_array_index((*entries)[i], at, fields.faults()));
  }
}

}  // namespace supple::json
