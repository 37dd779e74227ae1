#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "supple/base/error.h"

namespace supple {

/// Collects what is wrong with an input, so that one Error names all of it: the first 20 faults, and their number.
class Faults {
 public:
  static constexpr std::size_t most_details = 20;

  void add(std::string where, std::string message);
  void require(bool good, std::string where, std::string message) {
    if (!good) add(std::move(where), std::move(message));
  }
  bool any() const { return total_ > 0; }
  std::size_t total() const { return total_; }
  /// Whether further faults are counted and not named: what they say is not kept.
  bool only_counts() const { return details_.size() == most_details; }

  /// Throws an Error with this code if there are any faults. Its sentence is "<where>: <message> (and 2 more)" for the
  /// first fault, with `whole` in place of an empty where.
  void throw_if_any(const std::string& code, const std::string& whole = "The input") const;

 private:
  std::vector<Error::Detail> details_;
  std::size_t total_ = 0;
};

}  // namespace supple
