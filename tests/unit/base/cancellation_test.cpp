#include "supple/base/cancellation.h"

#include <gtest/gtest.h>

#include <new>
#include <thread>

#include "supple/base/best_so_far.h"
#include "supple/base/error.h"
#include "supple/base/execution.h"
#include "support/expect_error.h"

namespace supple {
namespace {

using testing::expect_cancelled;
using testing::expect_error;

TEST(Cancellation, LetsAComputationRunUntilAStopIsRequested) {
  const CancellationToken token;
  EXPECT_FALSE(token.requested());
  EXPECT_NO_THROW(token.throw_if_requested());
  token.request(StopReason::cancelled);
  EXPECT_TRUE(token.requested());
  expect_cancelled(StopReason::cancelled, [&] { token.throw_if_requested(); });
}

TEST(Cancellation, NamesTheReasonInTheError) {
  const CancellationToken deadline, shutdown;
  deadline.request(StopReason::deadline);
  shutdown.request(StopReason::shutdown);
  expect_cancelled(StopReason::deadline, [&] { deadline.throw_if_requested(); });
  expect_cancelled(StopReason::shutdown, [&] { shutdown.throw_if_requested(); });
}

TEST(Cancellation, KeepsTheFirstReason) {
  const CancellationToken token;
  token.request(StopReason::deadline);
  token.request(StopReason::cancelled);
  EXPECT_EQ(token.reason(), StopReason::deadline);
}

TEST(Cancellation, IsTakenBackForItsReasonOnlyAndCanBeRequestedAgain) {
  const CancellationToken token;
  EXPECT_FALSE(token.resume(StopReason::none));
  EXPECT_FALSE(token.resume(StopReason::deadline));
  token.request(StopReason::deadline);
  EXPECT_FALSE(token.resume(StopReason::memory));
  EXPECT_TRUE(token.requested());
  EXPECT_TRUE(token.resume(StopReason::deadline));
  EXPECT_NO_THROW(token.throw_if_requested());
  token.request(StopReason::cancelled);
  expect_cancelled(StopReason::cancelled, [&] { token.throw_if_requested(); });
}

TEST(Cancellation, KeepsWhatWasAskedForBetweenADeadlineAndItsResumption) {
  for (const StopReason first : {StopReason::deadline, StopReason::memory})
    for (const StopReason later : {StopReason::cancelled, StopReason::shutdown, StopReason::superseded}) {
      const CancellationToken token;
      token.request(first);
      token.request(later);
      token.request(StopReason::cancelled);  // the first of the later ones stands
      EXPECT_EQ(token.reason(), first) << "until it is taken back";
      EXPECT_TRUE(token.resume(first));
      expect_cancelled(later, [&] { token.throw_if_requested(); });
      EXPECT_FALSE(token.resume(first));
      EXPECT_EQ(token.reason(), later);
    }
  const CancellationToken token;
  token.request(StopReason::deadline);
  token.request(StopReason::memory);
  EXPECT_TRUE(token.resume(StopReason::deadline));
  EXPECT_FALSE(token.requested()) << "the report is to fit into the memory that is left for it";
}

TEST(Cancellation, LosesNoCancellationThatComesWhileADeadlineIsTakenBack) {
  for (int trial = 0; trial < 2000; ++trial) {
    const CancellationToken token;
    token.request(StopReason::deadline);
    std::thread client([&] { token.request(StopReason::cancelled); });
    EXPECT_TRUE(token.resume(StopReason::deadline));
    client.join();
    ASSERT_EQ(token.reason(), StopReason::cancelled);
  }
}

TEST(SearchUntilStopped, EndsItsReportWhereACancellationCameWithTheDeadline) {
  const CancellationToken token;
  const auto search = [&] {
    token.request(StopReason::deadline);
    token.request(StopReason::shutdown);
    token.throw_if_requested();
  };
  EXPECT_EQ(search_until_stopped(
                token, [] { return true; }, search),
            StopReason::deadline);
  expect_cancelled(StopReason::shutdown, [&] { token.throw_if_requested(); });
}

TEST(SearchUntilStopped, KeepsTheResultOfADeadlineOrALimitOfMemory) {
  for (const StopReason reason : {StopReason::deadline, StopReason::memory}) {
    const CancellationToken token;
    const auto search = [&] {
      token.request(reason);
      token.throw_if_requested();
    };
    EXPECT_EQ(search_until_stopped(
                  token, [] { return true; }, search),
              reason);
    EXPECT_NO_THROW(token.throw_if_requested()) << "the report goes on";
    expect_cancelled(reason, [&] {
      search_until_stopped(
          token, [] { return false; }, search);
    });
    EXPECT_TRUE(token.requested()) << "there is nothing to report";
  }
}

TEST(SearchUntilStopped, TakesARefusedBlockForALimitOfMemory) {
  const CancellationToken token;
  const auto refused = [] { throw std::bad_alloc(); };
  EXPECT_EQ(search_until_stopped(
                token, [] { return true; }, refused),
            StopReason::memory);
  EXPECT_THROW(search_until_stopped(
                   token, [] { return false; }, refused),
               std::bad_alloc);
  token.request(StopReason::memory);
  EXPECT_EQ(search_until_stopped(
                token, [] { return true; }, refused),
            StopReason::memory);
  EXPECT_FALSE(token.requested());
}

TEST(SearchUntilStopped, LetsEveryOtherStopPassAndReturnsWhereTheSearchEndsByItself) {
  const CancellationToken token;
  EXPECT_EQ(search_until_stopped(
                token, [] { return true; }, [] {}),
            StopReason::none);
  const auto failing = [] { throw Error("karcher.weights", "Bad."); };
  expect_error("karcher.weights", [&] {
    search_until_stopped(
        token, [] { return true; }, failing);
  });
  token.request(StopReason::cancelled);
  const auto search = [&] { token.throw_if_requested(); };
  expect_cancelled(StopReason::cancelled, [&] {
    search_until_stopped(
        token, [] { return true; }, search);
  });
}

TEST(SearchUntilStopped, HasASentenceForTheReasonsForWhichItKeepsItsResult) {
  EXPECT_EQ(stop_clause(StopReason::deadline), "the deadline passed");
  EXPECT_EQ(stop_sentence(StopReason::deadline, " before."), "The deadline passed before.");
  EXPECT_EQ(stop_sentence(StopReason::memory, " before."), "A limit of memory was reached before.");
}

TEST(PartUntilStopped, KeepsItsResultAndLeavesTheStopForTheOthers) {
  for (const StopReason reason : {StopReason::deadline, StopReason::memory, StopReason::cancelled}) {
    const CancellationToken token;
    token.request(reason);
    const auto search = [&] { token.throw_if_requested(); };
    const auto part = [&](bool has_result) {
      return part_until_stopped(
          token, [=] { return has_result; }, search);
    };
    expect_cancelled(reason, [&] { part(false); });
    if (reason == StopReason::cancelled)
      expect_cancelled(reason, [&] { part(true); });
    else
      EXPECT_EQ(part(true), reason);
    EXPECT_TRUE(token.requested());
  }
  const auto refused = [] { throw std::bad_alloc(); };
  EXPECT_EQ(part_until_stopped(
                CancellationToken(), [] { return true; }, refused),
            StopReason::memory);
}

TEST(Cancellation, IsSharedByCopiesButNotByNewTokens) {
  const CancellationToken token;
  const CancellationToken copy = token;
  const CancellationToken other;
  token.request(StopReason::cancelled);
  EXPECT_TRUE(copy.requested());
  EXPECT_FALSE(other.requested());
}

TEST(Cancellation, ReachesALoopInAnotherThread) {
  const CancellationToken token;
  bool stopped = false;
  std::thread worker([&] {
    try {
      for (;;) token.throw_if_requested();
    } catch (const Cancelled&) {
      stopped = true;
    }
  });
  token.request(StopReason::cancelled);
  worker.join();
  EXPECT_TRUE(stopped);
}

struct Recorder : ProgressSink {
  void report(double fraction, std::string_view stage) override {
    fractions.push_back(fraction);
    stages.emplace_back(stage);
  }
  std::vector<double> fractions;
  std::vector<std::string> stages;
};

TEST(Execution, CheckpointsReportProgressAndStopWhenAsked) {
  Recorder recorder;
  Execution execution;
  execution.checkpoint(0.1, "nobody listens");
  execution.progress = &recorder;
  execution.checkpoint(0.5, "propagate");
  EXPECT_EQ(recorder.fractions, std::vector<double>{0.5});
  EXPECT_EQ(recorder.stages, std::vector<std::string>{"propagate"});
  execution.cancellation.request(StopReason::cancelled);
  expect_cancelled(StopReason::cancelled, [&] { execution.checkpoint(0.6, "propagate"); });
  EXPECT_EQ(recorder.fractions.size(), 1u);
}

}  // namespace
}  // namespace supple
