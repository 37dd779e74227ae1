#include "supple/json/answers.h"
#include "supple/json/json_writer.h"
#include "supple/problem/error_table.h"

namespace supple::json {

std::string write_problem(const problem::Problem& problem) {
  const auto& kind = problem::error_kind(problem.code);
  JsonWriter out;
  out.begin_object()
      .field("type", "urn:supple:error:" + std::string(kind.code))
      .field("title", kind.title)
      .field("status", kind.status)
      .field("detail", problem.detail)
      .field("code", kind.code)
      .field("hint", kind.hint);
  if (!problem.errors.empty()) {
    out.key("errors").begin_array();
    for (const auto& error : problem.errors) {
      out.begin_object().field("pointer", error.where).field("detail", error.message);
      if (error.shortage) out.field("needed", error.shortage->needed).field("available", error.shortage->available);
      out.end_object();
    }
    out.end_array();
  }
  if (problem.limit) {
    out.field("limit", problem.limit->limit).field("value", problem.limit->value);
    if (!problem.limit->setting.empty()) out.field("setting", problem.limit->setting);
  }
  out.end_object();
  return out.take();
}

}  // namespace supple::json
