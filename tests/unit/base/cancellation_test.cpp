#include "supple/base/cancellation.h"

#include <gtest/gtest.h>

#include <thread>

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
