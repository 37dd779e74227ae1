#pragma once

#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/error.h"

namespace supple::problem {

/// A limit that was exceeded.
struct Limit {
  double limit = 0;
  double value = 0;
  std::string setting;  ///< the command line option that sets it; empty for fixed limits
};

/// An error as a client sees it (RFC 9457).
struct Problem {
  std::string code;                   ///< a row of api/errors.yaml
  std::string detail;                 ///< one sentence
  std::vector<Error::Detail> errors;  ///< `where` is a JSON pointer or a mesh element
  std::optional<Limit> limit;
  std::optional<int> retry_after;  ///< seconds
};

/// An Error that also carries a limit, or when to ask again.
class ProblemError : public Error {
 public:
  explicit ProblemError(Problem problem);
  const Problem& problem() const noexcept { return problem_; }

 private:
  Problem problem_;
};

/// Throws ProblemError `code`: "`what` is `value`, the limit is `limit` (setting `setting`)".
[[noreturn]] void throw_limit(const std::string& code, const std::string& what, double limit, double value,
                              const std::string& setting, const std::string& pointer = {});

/// What a client is told about an exception. An Error keeps its code and its details, whose paths ("points/3") become
/// JSON pointers ("/points/3"); std::bad_alloc is "server.out_of_memory"; anything else is "server.internal", and its
/// text stays with the server.
Problem problem_of(const std::exception_ptr& exception);

/// The HTTP status of the problem's code.
int status_of(const Problem& problem);

}  // namespace supple::problem
