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
  double value = 0;     ///< the value that exceeds the limit
  std::string setting;  ///< the command line option that sets the limit; empty for fixed limits
};

/// An error as a client sees it (RFC 9457).
struct Problem {
  std::string code;                   ///< the code of a row of api/errors.yaml
  std::string detail;                 ///< one sentence
  std::vector<Error::Detail> errors;  ///< `where` is a JSON pointer or a mesh element
  std::optional<Limit> limit;
  std::optional<int> retry_after;  ///< seconds after which the client may try again
  std::string allowed_methods{};   ///< methods of the path, as "GET, POST", if the request has another one
};

/// An Error that also carries what else a problem has: a limit, the time after which to try again, allowed methods.
class ProblemError : public Error {
 public:
  explicit ProblemError(Problem problem);
  const Problem& problem() const noexcept { return problem_; }

 private:
  Problem problem_;
};

/// Throws a ProblemError with this code and the text "`what` is `value`, the limit is `limit` (setting `setting`)".
/// `pointer` is the JSON pointer of the value, if it has one.
[[noreturn]] void throw_limit(const std::string& code, const std::string& what, double limit, double value,
                              const std::string& setting, const std::string& pointer = {});

/// The problem that tells a client of an exception. An Error keeps its code and its details, whose paths ("points/3")
/// become JSON pointers ("/points/3"). std::bad_alloc becomes "server.out_of_memory", anything else "server.internal"
/// without its text.
Problem problem_of(const std::exception_ptr& exception);

/// Whether an exception is neither an Error, nor a stop, nor a lack of memory, so that its text is for the log alone.
bool is_unexpected(const std::exception_ptr& exception);

/// The HTTP status of the problem's code.
int status_of(const Problem& problem);

}  // namespace supple::problem
