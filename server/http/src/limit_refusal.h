#pragma once

#include <exception>
#include <string>

#include "supple/problem/problem.h"

namespace supple::http {

/// The problem of a connection or a request that would be one more than `limit`, which `setting` sets.
inline std::exception_ptr limit_refusal(const std::string& code, const std::string& detail, double limit,
                                        const std::string& setting, int retry_seconds) {
  return std::make_exception_ptr(problem::ProblemError(
      {code, detail + " (setting " + setting + ").", {}, problem::Limit{limit, limit + 1, setting}, retry_seconds}));
}

}  // namespace supple::http
