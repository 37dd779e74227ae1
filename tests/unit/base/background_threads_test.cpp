#include "supple/base/background_threads.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "supple/base/helper_processes.h"
#include "supple/base/threads.h"

namespace supple {
namespace {

int niceness_of(int id) { return ::getpriority(PRIO_PROCESS, static_cast<id_t>(id)); }

/// Runs on a background thread and hands on what it throws.
template <class Work>
void in_background(const Work& work) {
  std::exception_ptr failure;
  std::thread thread([&] {
    become_background_thread();
    try {
      work();
    } catch (...) {
      failure = std::current_exception();
    }
  });
  thread.join();
  if (failure) std::rethrow_exception(failure);
}

TEST(BackgroundThreads, AreNicerThanOthersForTheirWholeLife) {
  const int own = niceness_of(::gettid());
  EXPECT_FALSE(is_background_thread());
  in_background([&] {
    EXPECT_TRUE(is_background_thread());
    EXPECT_EQ(niceness_of(::gettid()), std::min(19, own + 10));
    become_background_thread();
    EXPECT_EQ(niceness_of(::gettid()), std::min(19, own + 10)) << "once is enough";
  });
  EXPECT_EQ(niceness_of(::gettid()), own);
}

TEST(BackgroundThreads, RunTheBodyOnceForEachIndexAlsoInLoopsWithinLoops) {
  set_thread_count(4);
  std::vector<std::atomic<int>> runs(100 * 50);
  in_background([&] {
    parallel_for(100, [&](int i) {
      EXPECT_TRUE(is_background_thread());
      parallel_for(50, [&](int k) { ++runs[50 * i + k]; });
    });
    parallel_for(0, [](int) { FAIL(); });
  });
  set_thread_count(0);
  for (const auto& count : runs) EXPECT_EQ(count.load(), 1);
}

TEST(BackgroundThreads, HandAnExceptionToTheCallerAndGoOn) {
  in_background([] {
    const auto loop = [] {
      parallel_for(1000, [](int i) {
        if (i == 617) throw std::runtime_error("617");
      });
    };
    EXPECT_THROW(loop(), std::runtime_error);
    std::atomic<int> sum{0};
    parallel_for(10, [&](int i) { sum += i; });
    EXPECT_EQ(sum, 45);
  });
}

TEST(BackgroundThreads, HaveHelperProcessesOfTheirOwn) {
  HelperProcesses helpers({SUPPLE_TEST_HELPER, 1, 0});
  const int own = niceness_of(::getpid());
  const int ordinary = helpers.process_ids().at(0);
  in_background([&] { EXPECT_EQ(helpers.run("echo", "quiet", {}), "quiet"); });
  ASSERT_EQ(helpers.process_ids().size(), 2U);
  std::set<int> all;
  for (const int id : helpers.process_ids()) all.insert(niceness_of(id));
  EXPECT_EQ(all, (std::set{own, std::min(19, own + 10)}));
  EXPECT_EQ(niceness_of(ordinary), own);
  EXPECT_EQ(helpers.run("echo", "loud", {}), "loud");
  EXPECT_EQ(helpers.process_ids().size(), 2U) << "both are used again";
}

}  // namespace
}  // namespace supple
