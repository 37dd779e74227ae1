#pragma once

#include <string>
#include <utility>
#include <vector>

#include "supple/base/error.h"

namespace supple::weave {

/// Gathers what is wrong with an input, the first twenty faults, to report them together.
class Faults {
 public:
  void require(bool good, const std::string& where, const std::string& message) {
    if (!good && details_.size() < most_details) details_.push_back({where, message});
  }
  bool any() const { return !details_.empty(); }
  /// Throws an Error of this code where there are any.
  void throw_if_any(const std::string& code) const {
    if (any()) throw Error(code, details_.front().where + " " + details_.front().message, details_);
  }

 private:
  static constexpr std::size_t most_details = 20;
  std::vector<Error::Detail> details_;
};

}  // namespace supple::weave
