#include "supple/problem/problem.h"

#include <charconv>
#include <new>

#include "supple/base/cancellation.h"
#include "supple/problem/error_table.h"

namespace supple::problem {
namespace {

std::string plain_number(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

/// Turns a path "points/3" into the JSON pointer "/points/3". Mesh elements ("face 17") and JSON pointers are returned
/// unchanged.
std::string as_pointer(const std::string& where) {
  if (where.empty() || where.front() == '/' || where.find(' ') != std::string::npos) return where;
  return "/" + where;
}

const char* code_of(StopReason reason) {
  switch (reason) {
    case StopReason::deadline:
      return "job.deadline_exceeded";
    case StopReason::shutdown:
      return "server.shutting_down";
    case StopReason::superseded:
      return "design.superseded";
    case StopReason::memory:
      return "server.out_of_memory";
    default:
      return "job.cancelled";
  }
}

}  // namespace

ProblemError::ProblemError(Problem problem)
    : Error(problem.code, problem.detail, problem.errors), problem_(std::move(problem)) {}

void throw_limit(const std::string& code, const std::string& what, double limit, double value,
                 const std::string& setting, const std::string& pointer) {
  Problem problem;
  problem.code = code;
  problem.detail = what + " is " + plain_number(value) + ", the limit is " + plain_number(limit);
  if (!setting.empty()) problem.detail += " (setting " + setting + ")";
  problem.limit = Limit{limit, value, setting};
  if (!pointer.empty()) problem.errors.push_back({pointer, problem.detail});
  throw ProblemError(std::move(problem));
}

Problem problem_of(const std::exception_ptr& exception) {
  try {
    std::rethrow_exception(exception);
  } catch (const ProblemError& error) {
    return error.problem();
  } catch (const Error& error) {
    Problem problem{error.code(), error.what(), {}, {}, {}};
    for (const auto& detail : error.details())
      problem.errors.push_back({as_pointer(detail.where), detail.message, detail.shortage});
    return problem;
  } catch (const Cancelled& stop) {
    return {code_of(stop.reason()), stop.what(), {}, {}, {}};
  } catch (const std::bad_alloc&) {
    return {"server.out_of_memory", "There is not enough memory for this request.", {}, {}, 5};
  } catch (...) {
    return {"server.internal", "The server met an error that it did not expect; its log says more.", {}, {}, {}};
  }
}

bool is_unexpected(const std::exception_ptr& exception) {
  try {
    std::rethrow_exception(exception);
  } catch (const Error&) {
    return false;
  } catch (const Cancelled&) {
    return false;
  } catch (const std::bad_alloc&) {
    return false;
  } catch (...) {
    return true;
  }
}

int status_of(const Problem& problem) { return error_kind(problem.code).status; }

}  // namespace supple::problem
