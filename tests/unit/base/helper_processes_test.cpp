#include "supple/base/helper_processes.h"

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "supple/base/byte_codec.h"
#include "support/expect_error.h"

namespace supple {
namespace {

using testing::expect_cancelled;
using testing::expect_error;

HelperOptions options_of(int processes = 2) { return {SUPPLE_TEST_HELPER, processes, 0}; }

/// Whether a process of this id exists.
bool runs(int process) { return ::kill(process, 0) == 0; }

TEST(HelperProcesses, AnswerWithTheBytesOfTheTask) {
  HelperProcesses helpers(options_of());
  EXPECT_EQ(helpers.run("echo", "", {}), "");
  const std::string large(3'000'001, '\7');
  EXPECT_EQ(helpers.run("echo", large, {}), large) << "in both directions more than a socket holds";
  EXPECT_EQ(helpers.process_ids().size(), 1U) << "it is kept for the next task";
}

TEST(HelperProcesses, AnswerWhateverTheyHaveAnsweredBefore) {
  HelperProcesses helpers(options_of(1));
  const std::string first = helpers.run("remember", "abc", {});
  for (const std::string& other : {std::string(), std::string(5, 'x'), std::string(3'000'001, '\7')}) {
    helpers.run("remember", other, {});
    helpers.run("echo", other, {});
    EXPECT_EQ(helpers.run("remember", "abc", {}), first) << "after " << other.size() << " bytes";
  }
}

TEST(HelperProcesses, PassErrorsOnWithCodeAndDetails) {
  HelperProcesses helpers(options_of());
  const auto error = expect_error("tiling.meshing_failed", [&] { helpers.run("refuse", "", {}); });
  EXPECT_STREQ(error.what(), "No mesh.");
  EXPECT_EQ(testing::places(error), (std::vector<std::string>{"parameters", "size"}));
  EXPECT_EQ(error.details()[1].message, "is even");
  EXPECT_THROW(helpers.run("surprise", "", {}), std::runtime_error);
  EXPECT_THROW(helpers.run("unknown", "", {}), std::runtime_error);
}

TEST(HelperProcesses, AreKilledOnceAStopIsRequestedAndReplaced) {
  HelperProcesses helpers(options_of(1));
  const int process = helpers.process_ids().at(0);
  Execution execution;
  std::thread stopper([&execution] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    execution.cancellation.request(StopReason::deadline);
  });
  expect_cancelled(StopReason::deadline, [&] { helpers.run("spin", "", execution); });
  stopper.join();
  EXPECT_FALSE(runs(process));
  EXPECT_FALSE(runs(-process)) << "nothing is left of its group, in which its child was";
  ASSERT_EQ(helpers.process_ids().size(), 1U);
  EXPECT_NE(helpers.process_ids()[0], process);
  EXPECT_EQ(helpers.run("echo", "again", {}), "again");
}

TEST(HelperProcesses, MayCrashWithoutHarmToThisOne) {
  HelperProcesses helpers(options_of());
  const auto crash = expect_error("server.helper_ended", [&] { helpers.run("crash", "", {}); });
  EXPECT_NE(std::string(crash.what()).find("crash ended with signal 11"), std::string::npos) << crash.what();
  const auto leave = expect_error("server.helper_ended", [&] { helpers.run("leave", "", {}); });
  EXPECT_NE(std::string(leave.what()).find("leave ended with status 3"), std::string::npos) << leave.what();
  const auto silent = expect_error("server.helper_ended", [&] { helpers.run("leave without a word", "", {}); });
  EXPECT_NE(std::string(silent.what()).find("ended with status 0"), std::string::npos) << silent.what();
  EXPECT_EQ(helpers.run("echo", "again", {}), "again");
}

TEST(HelperProcesses, EndATaskThatComputesBeyondItsLimit) {
  HelperProcesses helpers(options_of());
  const auto spin = expect_error("server.helper_ended", [&] { helpers.run("spin for a second", "", {}); });
  EXPECT_NE(std::string(spin.what()).find("ended with signal " + std::to_string(SIGXCPU)), std::string::npos)
      << spin.what();
  EXPECT_EQ(helpers.run("echo", "again", {}), "again");
}

TEST(HelperProcesses, AreRefusedMemoryBeyondTheirLimit) {
#ifdef SUPPLE_SANITIZED
  GTEST_SKIP() << "sanitizers need terabytes of address space";
#endif
  HelperOptions options = options_of();
  options.memory = 1ULL << 30;
  HelperProcesses helpers(options);
  const auto error = expect_error("server.out_of_memory", [&] { helpers.run("swell", "", {}); });
  EXPECT_NE(std::string(error.what()).find("1073741824 bytes"), std::string::npos) << error.what();
  EXPECT_EQ(helpers.run("echo", "again", {}), "again");
}

TEST(HelperProcesses, WaitForEachOtherBeyondTheirNumberAndStopWaitingWhenAsked) {
  HelperProcesses helpers(options_of(1));
  Execution first;
  std::thread busy([&] { EXPECT_THROW(helpers.run("spin", "", first), Cancelled); });
  while (helpers.process_ids().empty()) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  Execution second;
  std::thread stopper([&second] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    second.cancellation.request(StopReason::cancelled);
  });
  expect_cancelled(StopReason::cancelled, [&] { helpers.run("echo", "", second); });
  stopper.join();
  first.cancellation.request(StopReason::cancelled);
  busy.join();
}

TEST(HelperProcesses, EndWithTheProcessThatStartedThem) {
  // A child starts a helper, leaves it in an endless loop and is killed. The pipe passes the helper's process id.
  ASSERT_EQ(::prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    HelperProcesses helpers(options_of(1));
    const int helper = helpers.process_ids().at(0);
    if (::write(ends[1], &helper, sizeof helper) != sizeof helper) std::_Exit(1);
    try {
      helpers.run("spin", "", {});
    } catch (const std::exception&) {
      std::_Exit(2);
    }
    std::_Exit(3);
  }
  int helper = 0;
  ASSERT_EQ(::read(ends[0], &helper, sizeof helper), static_cast<ssize_t>(sizeof helper));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  ASSERT_TRUE(runs(helper));
  ASSERT_EQ(::kill(child, SIGKILL), 0);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  // This process becomes the parent of the helper and its child, which are one process group.
  const auto ended = [helper] { return ::waitpid(-helper, nullptr, WNOHANG) < 0 && errno == ECHILD; };
  for (int look = 0; look < 6000 && !ended(); ++look) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(ended());
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(HelperProcesses, CannotBeOfAProgramThatDoesNotExist) {
  EXPECT_THROW(HelperProcesses({"/nonexistent/helper", 1, 0}), std::runtime_error);
}

TEST(ByteCodec, ReadsWhatItHasWrittenAndNothingBeyondTheEnd) {
  const std::string bytes = ByteWriter().number(-1.5).text("ab").list(std::vector<int>{3, 4, 5}, [](int) {}).take();
  ByteReader reader(bytes);
  EXPECT_EQ(reader.number<double>(), -1.5);
  EXPECT_EQ(reader.text(), "ab");
  std::vector<int> values;
  EXPECT_THROW(reader.list(values, [&reader] { return reader.number<int>(); }), std::out_of_range);
  EXPECT_TRUE(reader.at_end());
}

}  // namespace
}  // namespace supple
