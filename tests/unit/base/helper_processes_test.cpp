#include "supple/base/helper_processes.h"

#include <gtest/gtest.h>
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

using testing::expect_error;

HelperOptions options_of(int processes = 2) { return {SUPPLE_TEST_HELPER, processes, 0}; }

/// Whether a process of this number runs; one that has ended and was not waited for does not.
bool runs(int process) { return ::kill(process, 0) == 0; }

TEST(HelperProcesses, AnswerWithTheBytesOfTheTask) {
  HelperProcesses helpers(options_of());
  EXPECT_EQ(helpers.run("echo", "", {}), "");
  const std::string large(3'000'001, '\7');
  EXPECT_EQ(helpers.run("echo", large, {}), large) << "in both directions more than a socket holds";
  EXPECT_EQ(helpers.process_ids().size(), 1U) << "it is kept for the next task";
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
  expect_error("job.deadline_exceeded", [&] { helpers.run("spin", "", execution); });
  stopper.join();
  EXPECT_FALSE(runs(process));
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
  std::thread busy([&] { EXPECT_THROW(helpers.run("spin", "", first), Error); });
  while (helpers.process_ids().empty()) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  Execution second;
  std::thread stopper([&second] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    second.cancellation.request(StopReason::cancelled);
  });
  expect_error("job.cancelled", [&] { helpers.run("echo", "", second); });
  stopper.join();
  first.cancellation.request(StopReason::cancelled);
  busy.join();
}

TEST(HelperProcesses, EndWithTheProcessThatStartedThem) {
  // A child starts a helper, leaves it spinning and is killed; the pipe tells which process the helper is.
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
  // Whoever inherits it may leave it a zombie: it runs no more where its state says so.
  const auto ended = [helper] {
    const std::string file = "/proc/" + std::to_string(helper) + "/stat";
    std::FILE* const stat = std::fopen(file.c_str(), "r");
    if (!stat) return true;
    char state = '?';
    const int read = std::fscanf(stat, "%*d (%*[^)]) %c", &state);
    std::fclose(stat);
    return read != 1 || state == 'Z' || state == 'X';
  };
  for (int look = 0; look < 500 && !ended(); ++look) std::this_thread::sleep_for(std::chrono::milliseconds(10));
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
