#include "refusals.h"

#include <utility>

#include "supple/problem/problem.h"

namespace supple::budget {
namespace {

constexpr int retry_after_seconds = 5;  // a request holds its memory only while it is read and answered

}  // namespace

void refuse_one(std::int64_t limit, std::int64_t needed, const std::string& what) {
  problem::throw_limit("request.too_much_memory", "What the request needs in bytes of memory, with " + what + ",",
                       static_cast<double>(limit), static_cast<double>(needed), "--max-request-memory");
}

void refuse_all(std::int64_t limit, std::int64_t needed, const std::string& what) {
  problem::Problem problem{"server.out_of_memory", {}, {}, {}, retry_after_seconds};
  problem.limit = problem::Limit{static_cast<double>(limit), static_cast<double>(needed), "--memory"};
  problem.detail = "With " + what + " all requests together would need " + std::to_string(needed) +
                   " bytes of memory, the limit is " + std::to_string(limit) + " (setting --memory).";
  throw problem::ProblemError(std::move(problem));
}

void refuse_process(std::int64_t resident, const std::string& what) {
  throw problem::ProblemError({"server.out_of_memory",
                               "There is no memory left for " + what + ": the server has " + std::to_string(resident) +
                                   " bytes, which is nearly all that it may have.",
                               {},
                               {},
                               retry_after_seconds});
}

}  // namespace supple::budget
