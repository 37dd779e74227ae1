#include "supple/trainings/lab_process.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "support/expect_error.h"
#include "support/temporary_folder.h"

namespace supple::trainings {
namespace {

using namespace std::chrono_literals;

LabCommand shell(const std::string& script) { return {.program = "/bin/sh", .arguments = {"-c", script}}; }

/// Waits until a condition holds, for at most ten seconds.
template <class Condition>
bool comes_true(const Condition& condition) {
  for (int k = 0; k < 1000; ++k) {
    if (condition()) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

/// The process id that a script has written into a file; 0 while there is none.
pid_t id_in(const std::filesystem::path& path) {
  std::ifstream file(path);
  pid_t id = 0;
  file >> id;
  return file ? id : 0;
}

bool is_running(pid_t id) {
  std::ifstream file("/proc/" + std::to_string(id) + "/stat");
  std::string number, name, state;
  file >> number >> name >> state;
  return file && state != "Z";
}

TEST(RunLab, HandsOnEachLineAndTheEndOfTheErrors) {
  std::vector<std::string> lines;
  const auto ending = run_lab(shell("echo one; printf 'two\\nunfinished'; echo fault >&2; exit 3"), {},
                              [&](std::string_view line) { lines.emplace_back(line); });
  EXPECT_EQ(lines, (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(ending.status, 3);
  EXPECT_FALSE(ending.stopped);
  EXPECT_EQ(ending.errors, "fault\n");
}

TEST(RunLab, KeepsOnlyTheEndOfManyErrorsAndTheBeginningOfALongLine) {
  std::size_t longest = 0;
  const auto ending =
      run_lab(shell("head -c 100000 /dev/zero | tr '\\0' x; echo; head -c 100000 /dev/zero | tr '\\0' y "
                    ">&2; echo end >&2"),
              {}, [&](std::string_view line) { longest = line.size(); });
  EXPECT_EQ(longest, 4000U);
  EXPECT_EQ(ending.errors.size(), 4000U);
  EXPECT_TRUE(ending.errors.ends_with("yend\n"));
}

TEST(RunLab, AsksTheProgramToEndWhenAStopIsRequested) {
  const CancellationToken token;
  bool has_begun = false;
  const auto ending = run_lab(shell("trap 'echo kept; exit 7' TERM; echo begun; while :; do sleep 0.02; done"), token,
                              [&](std::string_view line) {
                                has_begun |= line == "begun";
                                token.request(StopReason::cancelled);
                              });
  EXPECT_TRUE(has_begun);
  EXPECT_TRUE(ending.stopped);
  EXPECT_EQ(ending.status, 7);
}

TEST(RunLab, KillsAProgramThatDoesNotEndAndAllThatItHasStarted) {
  const testing::TemporaryFolder folder;
  const auto file = folder / "id";
  auto command = shell("trap '' TERM; sh -c 'trap \"\" TERM; echo $$ > " + file.string() +
                       "; while :; do sleep 0.02; done' & echo begun; wait; wait");
  command.grace = 100ms;
  const CancellationToken token;
  const auto ending = run_lab(command, token, [&](std::string_view) { token.request(StopReason::deadline); });
  EXPECT_EQ(ending.status, 128 + SIGKILL);
  const auto grandchild = id_in(file);
  EXPECT_TRUE(grandchild == 0 || comes_true([&] { return !is_running(grandchild); }));
}

TEST(RunLab, LimitsTheMemory) {
  auto command = shell("exec /usr/bin/python3 -c 'x = bytearray(10**9)'");
  command.memory = 500'000'000;
  const auto ending = run_lab(command, {}, [](std::string_view) {});
  EXPECT_NE(ending.status, 0);
  EXPECT_NE(ending.errors.find("MemoryError"), std::string::npos) << ending.errors;
}

TEST(RunLab, SaysThatAProgramIsNotThere) {
  testing::expect_error("training.unavailable",
                        [] { (void)run_lab({.program = "/nowhere/supple-lab", .arguments = {}}, {}, {}); });
}

TEST(RunLab, TakesTheProgramWithItWhenItsProcessIsKilled) {
  const testing::TemporaryFolder folder;
  const auto file = folder / "id";
  const pid_t server = ::fork();
  ASSERT_GE(server, 0);
  if (server == 0) {
    run_lab(shell("echo $$ > " + file.string() + "; exec sleep 60"), {}, [](std::string_view) {});
    ::_exit(0);
  }
  ASSERT_TRUE(comes_true([&] { return id_in(file) > 0; }));
  const auto program = id_in(file);
  EXPECT_TRUE(is_running(program));
  ::kill(server, SIGKILL);
  ::waitpid(server, nullptr, 0);
  EXPECT_TRUE(comes_true([&] { return !is_running(program); }));
}

}  // namespace
}  // namespace supple::trainings
