#include "supple/problem/problem.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

#include "supple/base/cancellation.h"

namespace supple::problem {
namespace {

template <class Exception>
Problem told_of(const Exception& exception) {
  return problem_of(std::make_exception_ptr(exception));
}

TEST(Problem, KeepsAnErrorsCodeAndTurnsItsPathsIntoPointers) {
  const auto problem =
      told_of(Error("karcher.weights", "Bad.", {{"weights/2", "is negative"}, {"face 17", "x"}, {"/a", "y"}}));
  EXPECT_EQ(problem.code, "karcher.weights");
  ASSERT_EQ(problem.errors.size(), 3U);
  EXPECT_EQ(problem.errors[0].where, "/weights/2");
  EXPECT_EQ(problem.errors[1].where, "face 17");
  EXPECT_EQ(problem.errors[2].where, "/a");
}

TEST(Problem, NamesLimitValueAndSetting) {
  try {
    throw_limit("request.limit_exceeded", "The number of pairs", 10, 11.5, "--max-pairs", "/pairs");
  } catch (const ProblemError& error) {
    EXPECT_EQ(std::string(error.what()), "The number of pairs is 11.5, the limit is 10 (setting --max-pairs)");
    ASSERT_TRUE(error.problem().limit);
    EXPECT_EQ(error.problem().limit->value, 11.5);
    EXPECT_EQ(error.problem().errors.at(0).where, "/pairs");
    return;
  }
  FAIL() << "nothing was thrown";
}

TEST(Problem, KeepsTheTextOfUnexpectedExceptionsToTheServer) {
  const auto problem = told_of(std::runtime_error("secret path /etc/x"));
  EXPECT_EQ(problem.code, "server.internal");
  EXPECT_EQ(problem.detail.find("secret"), std::string::npos);
}

TEST(Problem, ExpectsErrorsStopsAndALackOfMemoryAlone) {
  const auto unexpected = [](const auto& exception) {
    const bool result = is_unexpected(std::make_exception_ptr(exception));
    EXPECT_EQ(result, told_of(exception).code == "server.internal");
    return result;
  };
  EXPECT_FALSE(unexpected(Error("karcher.weights", "Bad.")));
  EXPECT_FALSE(unexpected(ProblemError({"store.full", "Full.", {}, {}, 60})));
  EXPECT_FALSE(unexpected(Cancelled(StopReason::deadline)));
  EXPECT_FALSE(unexpected(std::bad_alloc()));
  EXPECT_TRUE(unexpected(std::runtime_error("secret")));
  EXPECT_TRUE(unexpected(7));
}

TEST(Problem, SaysThatMemoryRanOut) { EXPECT_EQ(status_of(told_of(std::bad_alloc())), 503); }

}  // namespace
}  // namespace supple::problem
