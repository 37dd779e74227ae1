#pragma once

#include <exception>
#include <utility>

#include "supple/problem/problem.h"

namespace supple {

/// The problem that a client is told of what `call` throws. Its code is "nothing was thrown" if `call` returns.
template <typename Call>
problem::Problem thrown_problem(Call&& call) {
  try {
    std::forward<Call>(call)();
  } catch (...) {
    return problem::problem_of(std::current_exception());
  }
  problem::Problem none;
  none.code = "nothing was thrown";
  return none;
}

}  // namespace supple
