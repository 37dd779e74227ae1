#include "compute_slots.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "supple/base/error.h"

namespace supple::jobs {
namespace {

TEST(ComputeSlots, NeverRunMoreThanTheirNumber) {
  ComputeSlots slots(3);
  std::atomic<int> running{0};
  std::atomic<int> most{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 16; ++i) {
    threads.emplace_back([&] {
      for (int j = 0; j < 20; ++j) {
        const ComputeSlots::Slot slot(slots, {});
        const int now = ++running;
        int seen = most;
        while (now > seen && !most.compare_exchange_weak(seen, now)) {
        }
        std::this_thread::sleep_for(std::chrono::microseconds(100));
        --running;
      }
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_LE(most, 3);
  EXPECT_GE(most, 2);
  EXPECT_EQ(slots.in_use(), 0);
}

TEST(ComputeSlots, LetGoOfAWaitingComputationThatIsCancelled) {
  ComputeSlots slots(1);
  const ComputeSlots::Slot taken(slots, {});
  const CancellationToken token;
  std::thread canceller([&] {
    while (slots.in_use() < 2) std::this_thread::yield();
    token.request(StopReason::cancelled);
  });
  EXPECT_THROW(ComputeSlots::Slot(slots, token), Cancelled);
  canceller.join();
  EXPECT_EQ(slots.in_use(), 1);
}

TEST(ComputeSlots, AreTakenNextByTheClientThatHasTheFewest) {
  ComputeSlots slots(2);
  std::mutex mutex;
  std::string order;
  std::vector<std::thread> threads;
  const ComputeSlots::Slot kept(slots, {}, "many");
  std::optional<ComputeSlots::Slot> given_back(std::in_place, slots, CancellationToken(), "many");
  int in_use = 2;
  for (const char* const client : {"many", "many", "few"}) {
    threads.emplace_back([&, client] {
      const ComputeSlots::Slot slot(slots, {}, client);
      const std::lock_guard lock(mutex);
      order += client[0];
    });
    for (++in_use; slots.in_use() < in_use;) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  given_back.reset();
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(order, "fmm");
  EXPECT_EQ(slots.in_use(), 1);
}

TEST(ComputeSlots, AreTakenByInteractiveComputationsFirstAndOneOfThemNeedsNone) {
  ComputeSlots slots(1);
  std::mutex mutex;
  std::string order;
  std::vector<std::thread> threads;
  std::optional<ComputeSlots::Slot> taken(std::in_place, slots, CancellationToken());
  std::optional<ComputeSlots::Slot> beyond(std::in_place, slots, CancellationToken(), "", Priority::interactive);
  EXPECT_EQ(slots.in_use(), 2) << "it did not wait";
  int in_use = 2;
  for (const auto priority : {Priority::normal, Priority::normal, Priority::interactive}) {
    threads.emplace_back([&, priority] {
      const ComputeSlots::Slot slot(slots, {}, "", priority);
      const std::lock_guard lock(mutex);
      order += priority_name(priority)[0];
    });
    for (++in_use; slots.in_use() < in_use;) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  beyond.reset();
  taken.reset();
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(order, "inn");
}

/// Computations that wait for a slot and note their letters once they have it.
class Queue {
 public:
  explicit Queue(ComputeSlots& slots) : slots_(slots) {}
  ~Queue() { join(); }

  void add(char letter, const std::string& client, Priority priority) {
    const int before = slots_.in_use();
    const std::size_t noted = order().size();
    threads_.emplace_back([this, letter, client, priority] {
      const ComputeSlots::Slot slot(slots_, {}, client, priority);
      const std::lock_guard lock(mutex_);
      order_ += letter;
    });
    while (slots_.in_use() == before && order().size() == noted) std::this_thread::yield();
  }
  void join() {
    for (auto& thread : threads_) thread.join();
    threads_.clear();
  }
  std::string order() {
    const std::lock_guard lock(mutex_);
    return order_;
  }

 private:
  ComputeSlots& slots_;
  std::mutex mutex_;
  std::string order_;
  std::vector<std::thread> threads_;
};

TEST(ComputeSlots, AreNotAllTakenByTheInteractiveComputationsOfOneClient) {
  ComputeSlots slots(2);
  const ComputeSlots::Slot first(slots, {}, "many", Priority::interactive);
  std::optional<ComputeSlots::Slot> second(std::in_place, slots, CancellationToken(), "", Priority::normal);
  Queue queue(slots);
  queue.add('m', "many", Priority::interactive);  // beyond half of the slots, it does not get the one beyond them
  queue.add('n', "few", Priority::normal);
  second.reset();
  queue.join();
  EXPECT_EQ(queue.order(), "nm");
}

TEST(ComputeSlots, AreGivenToOthersOnceManyInteractiveComputationsHaveGoneFirst) {
  ComputeSlots slots(1);
  std::optional<ComputeSlots::Slot> taken(std::in_place, slots, CancellationToken(), "", Priority::normal);
  std::optional<ComputeSlots::Slot> beyond(std::in_place, slots, CancellationToken(), "many", Priority::interactive);
  Queue queue(slots);
  queue.add('n', "few", Priority::normal);
  for (int i = 0; i < 2 * ClientTurns::max_in_succession; ++i) queue.add('i', "many", Priority::interactive);
  taken.reset();  // nothing starts: the one slot is that of the interactive computation now
  beyond.reset();
  queue.join();
  // The computation before it may still run, in the slot beyond, and note itself after it or before.
  EXPECT_NEAR(static_cast<double>(queue.order().find('n')), ClientTurns::max_in_succession, 1);
}

}  // namespace
}  // namespace supple::jobs
