#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/base/error.h"

namespace supple::testing {

/// Runs `action`, expects that it throws an Error of this type and code, and returns the error, or one with the code ""
/// if none was thrown.
template <typename Thrown = Error, typename Action>
Error expect_error(const std::string& code, Action&& action) {
  try {
    std::forward<Action>(action)();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_NE(dynamic_cast<const Thrown*>(&error), nullptr) << "it is of another type: " << error.what();
    return error;
  }
  ADD_FAILURE() << "expected the error " << code << ", but none was thrown";
  return Error("", "");
}

/// Runs `action` and expects it to end with Cancelled for that reason.
template <typename Action>
void expect_cancelled(StopReason reason, Action&& action) {
  try {
    std::forward<Action>(action)();
  } catch (const Cancelled& stop) {
    EXPECT_EQ(stop.reason(), reason) << stop.what();
    return;
  }
  ADD_FAILURE() << "expected the action to be cancelled, but it ended";
}

/// The places of the error's details, in order.
inline std::vector<std::string> places(const Error& error) {
  std::vector<std::string> result;
  for (const Error::Detail& detail : error.details()) result.push_back(detail.where);
  return result;
}

/// The text that `read` returns. If it throws an Error, which must have the code if one is given, the places of its
/// details separated by blanks.
template <typename Read>
std::string text_or_places(Read&& read, const std::string& code = {}) {
  try {
    return std::forward<Read>(read)();
  } catch (const Error& error) {
    if (!code.empty()) {
      EXPECT_EQ(error.code(), code) << error.what();
    }
    std::string result;
    for (const std::string& place : places(error)) result += (result.empty() ? "" : " ") + place;
    return result;
  }
}

}  // namespace supple::testing
