#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "supple/base/error.h"

namespace supple {

/// Collects the faults of an input, so that one Error names the first 20 of them, and their number.
class Faults {
 public:
  static constexpr std::size_t max_details = 20;

  void add(std::string where, std::string message);
  void require(bool good, std::string where, std::string message) {
    if (!good) add(std::move(where), std::move(message));
  }
  bool any() const { return total_ > 0; }
  std::size_t total() const { return total_; }
  /// Whether further faults are only counted, and their messages dropped.
  bool drops_further_details() const { return details_.size() == max_details; }

  /// Throws an error of this type and code if there are any faults. Its sentence is "<where>: <message> (and 2 more)"
  /// for the first fault, with `whole` in place of an empty where.
  template <class Thrown = Error>
  void throw_if_any(const std::string& code, const std::string& whole = "The input") const {
    if (any()) throw Thrown(code, sentence(whole), details_);
  }

 private:
  std::string sentence(const std::string& whole) const;

  std::vector<Error::Detail> details_;
  std::size_t total_ = 0;
};

}  // namespace supple
