// The parts of a queue, each by itself.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "journal.h"
#include "scheduler.h"
#include "store_doubles.h"
#include "supple/json/answers.h"
#include "support/temporary_folder.h"

namespace supple::jobs {
namespace {

/// A board and a scheduler without workers.
class JobPartsTest : public ::testing::Test {
 protected:
  JobPointer job(const std::string& id, Computation computation = {}, Row row = Row::none, int attempts = 0) {
    store::JobRecord record;
    record.id = id;
    record.mesh = computation.mesh;
    record.attempts = attempts;
    return std::make_shared<Job>(board_, watchdog_, std::move(computation), std::move(record), false, row);
  }
  static Computation of_client(const std::string& client, std::int64_t bytes = 0, int max_waiting = 0) {
    Computation computation;
    computation.client = client;
    computation.bytes = bytes;
    computation.max_waiting = max_waiting;
    return computation;
  }
  static std::optional<problem::Problem> refusal(const FairQueue& queue, const Computation& computation) {
    try {
      queue.require_place(computation);
    } catch (const problem::ProblemError& error) {
      return error.problem();
    }
    return std::nullopt;
  }
  static Computation of_priority(Priority priority, const std::string& client = {}) {
    auto computation = of_client(client);
    computation.priority = priority;
    return computation;
  }
  static JobPointer next(const FairQueue& queue) { return queue.next(Priority::interactive, Priority::background); }
  /// A worker of this kind that has begun a job.
  Scheduler::Seat& start_job(WorkerKind kind) {
    auto& seat = scheduler_.add_seat(kind);
    EXPECT_TRUE(scheduler_.take(seat));
    return seat;
  }
  static std::string id_of(const JobPointer& job) { return job ? job->id : ""; }

  QueueOptions options_;
  Watchdog watchdog_;
  Sessions sessions_;
  JobBoard board_{false};
  Scheduler scheduler_{options_, board_, sessions_};
};

TEST_F(JobPartsTest, AQueueGivesTheFirstJobOfTheClientWithTheFewestThatIsNotPaused) {
  FairQueue queue(options_);
  const auto a1 = job("a1", of_client("a"));
  const auto a2 = job("a2", of_client("a"));
  const auto b = job("b", of_client("b"));
  for (const auto& one : {a1, a2, b}) queue.add(one, false);
  EXPECT_EQ(id_of(next(queue)), "a1");
  queue.pause(*a1, true);
  EXPECT_EQ(id_of(next(queue)), "a2");
  queue.pause(*a1, false);
  queue.remove(*a1);
  queue.begin(*a1);
  EXPECT_EQ(id_of(next(queue)), "b");
  queue.begin(*b);
  EXPECT_EQ(id_of(next(queue)), "a2") << "both have one";
  queue.end("a", Priority::normal);
  queue.remove(*a2);
  queue.pause(*b, true);
  EXPECT_EQ(next(queue), nullptr);
  EXPECT_EQ(queue.size(), 1U);
  EXPECT_EQ(queue.jobs(), std::vector{b});
  b->token.request(StopReason::cancelled);
  EXPECT_TRUE(queue.stopped_jobs().empty()) << "it is paused";
  queue.pause(*b, false);
  EXPECT_EQ(queue.stopped_jobs(), std::vector{b});
}

TEST_F(JobPartsTest, AQueueGivesUrgentJobsFirstAndIsFairAmongThoseOfOnePriority) {
  FairQueue queue(options_);
  const auto background = job("background", of_priority(Priority::background, "a"));
  const auto normal = job("normal", of_priority(Priority::normal, "b"));
  const auto first = job("first", of_priority(Priority::interactive, "a"));
  const auto second = job("second", of_priority(Priority::interactive, "b"));
  for (const auto& one : {background, normal, first, second}) queue.add(one, false);
  EXPECT_EQ(queue.size(Priority::interactive), 2U);
  EXPECT_EQ(queue.size(Priority::background), 1U);
  EXPECT_EQ(id_of(next(queue)), "first");
  queue.begin(*job("runs", of_priority(Priority::background, "a")));
  EXPECT_EQ(id_of(next(queue)), "first") << "jobs in the background take no worker from others";
  queue.begin(*job("runs too", of_priority(Priority::normal, "a")));
  EXPECT_EQ(id_of(next(queue)), "second") << "its client has none";
  queue.remove(*second);
  EXPECT_EQ(id_of(next(queue)), "first") << "it comes before a normal job of a client without any";
  EXPECT_EQ(id_of(queue.next(Priority::normal, Priority::normal)), "normal");
  EXPECT_EQ(id_of(queue.next(Priority::background, Priority::background)), "background");
  queue.end("a", Priority::normal);
  queue.end("a", Priority::background);
  for (const auto& one : {first, normal}) queue.remove(*one);
  EXPECT_EQ(id_of(next(queue)), "background");
}

TEST_F(JobPartsTest, AQueueGivesInteractiveJobsOfOneClientHalfOfTheWorkersFirst) {
  options_.workers = 4;
  FairQueue queue(options_);
  queue.begin(*job("runs", of_priority(Priority::interactive, "many")));
  const auto many = job("many", of_priority(Priority::interactive, "many"));
  const auto few = job("few", of_priority(Priority::normal, "few"));
  const auto own = job("own", of_priority(Priority::normal, "many"));
  for (const auto& one : {own, many, few}) queue.add(one, false);
  EXPECT_EQ(id_of(next(queue)), "many") << "half of the workers is two";
  queue.begin(*job("runs too", of_priority(Priority::interactive, "many")));
  EXPECT_EQ(id_of(next(queue)), "few");
  EXPECT_EQ(queue.next(Priority::interactive, Priority::interactive), nullptr) << "nor is there a worker beyond";
  queue.remove(*few);
  EXPECT_EQ(id_of(next(queue)), "many") << "it comes before a normal one of its own client";
  const auto other = job("other", of_priority(Priority::interactive, "other"));
  queue.add(other, false);
  EXPECT_EQ(id_of(queue.next(Priority::interactive, Priority::interactive)), "other");
}

TEST_F(JobPartsTest, AQueueGivesOthersTheirTurnAfterSomeInteractiveJobsInSuccession) {
  options_.workers = 1;
  FairQueue queue(options_);
  const auto waits = job("waits", of_priority(Priority::normal, "few"));
  const auto drag = job("drag", of_priority(Priority::interactive, "many"));
  for (const auto& one : {waits, drag}) queue.add(one, false);
  const auto run = [&](const JobPointer& one) {
    queue.begin(*one);
    queue.end(one->computation.client, one->computation.priority);
  };
  for (int i = 0; i < ClientTurns::max_in_succession; ++i) {
    EXPECT_EQ(id_of(next(queue)), "drag") << i;
    run(drag);
  }
  EXPECT_EQ(id_of(next(queue)), "waits");
  EXPECT_EQ(id_of(queue.next(Priority::interactive, Priority::interactive)), "drag") << "a worker beyond is for these";
  run(waits);
  EXPECT_EQ(id_of(next(queue)), "drag");
  queue.pause(*waits, true);
  for (int i = 0; i < 2 * ClientTurns::max_in_succession; ++i) run(drag);
  queue.pause(*waits, false);
  EXPECT_EQ(id_of(next(queue)), "drag") << "nobody waited";
}

TEST_F(JobPartsTest, JobsInTheBackgroundTakeNoPlaceFromOthersInAQueue) {
  options_.max_queue = 2;
  options_.max_queue_bytes = 100;
  FairQueue queue(options_);
  const auto asking = [](Priority priority, std::int64_t bytes) {
    auto computation = of_client("a", bytes, 2);
    computation.priority = priority;
    return computation;
  };
  for (const char* const id : {"a", "b"}) queue.add(job(id, asking(Priority::background, 50)), false);
  for (const auto priority : {Priority::interactive, Priority::normal})
    EXPECT_FALSE(refusal(queue, asking(priority, 100)));
  const auto full = refusal(queue, asking(Priority::background, 0));
  EXPECT_EQ(full->code, "job.client_queue_full");
  EXPECT_NE(full->detail.find("2 jobs in the background"), std::string::npos) << full->detail;
  auto of_other = asking(Priority::background, 1);
  of_other.client = "b";
  EXPECT_EQ(refusal(queue, of_other)->limit->setting, "--max-queue");
  options_.max_queue = 3;
  EXPECT_EQ(refusal(queue, of_other)->limit->setting, "--max-queue-bytes");
  queue.add(job("c", asking(Priority::normal, 60)), false);
  EXPECT_EQ(refusal(queue, asking(Priority::interactive, 41))->limit->value, 101);
}

TEST_F(JobPartsTest, AQueueGivesNoLastAttemptBesideAnother) {
  options_.max_attempts = 3;
  FairQueue queue(options_);
  const auto last = job("last", {}, Row::written, 2);
  const auto other = job("other", {}, Row::written, 1);
  EXPECT_TRUE(queue.is_last_attempt(*last));
  EXPECT_FALSE(queue.is_last_attempt(*other));
  for (const auto& one : {last, other}) queue.add(one, false);
  queue.set_last_attempt_runs(true);
  EXPECT_EQ(id_of(next(queue)), "other");
  queue.set_last_attempt_runs(false);
  EXPECT_EQ(id_of(next(queue)), "last");
  options_.max_attempts = 1;
  EXPECT_FALSE(queue.is_last_attempt(*job("new"))) << "a first attempt is not suspect";
}

TEST_F(JobPartsTest, AQueueSaysWhenThereIsAPlaceAgain) {
  options_.workers = 2;
  options_.max_queue = 2;
  options_.max_queue_bytes = 100;
  FairQueue queue(options_);
  const auto a = job("a", of_client("a", 60));
  queue.add(a, true);
  EXPECT_FALSE(refusal(queue, of_client("a", 40, 2)));
  EXPECT_EQ(refusal(queue, of_client("a", 40, 1))->code, "job.client_queue_full");
  EXPECT_FALSE(refusal(queue, of_client("b", 40, 1)));
  EXPECT_EQ(refusal(queue, of_client("b", 41))->retry_after, 1);
  for (int i = 0; i < 1000; ++i) queue.note_time(10);
  EXPECT_EQ(refusal(queue, of_client("b", 41))->retry_after, 5) << "half the mean of one worker";
  queue.note_time(20);
  EXPECT_EQ(refusal(queue, of_client("b", 41))->retry_after, 6) << "10 s + a tenth of the difference, by two workers";
  for (int i = 0; i < 1000; ++i) queue.note_time(1e6);
  EXPECT_EQ(refusal(queue, of_client("b", 41))->retry_after, 3600);
  queue.add(job("b", of_client("b")), false);
  EXPECT_EQ(refusal(queue, of_client("c"))->code, "job.queue_full");
  queue.remove(*a);
  EXPECT_FALSE(refusal(queue, of_client("c", 100)));
}

TEST_F(JobPartsTest, AComputationThatLeavesLateDoesNotTakeTheSessionFromALaterOne) {
  const CancellationToken first;
  const CancellationToken second;
  const CancellationToken third;
  const auto number = sessions_.enter("s", first);
  sessions_.enter("s", second);
  EXPECT_EQ(first.reason(), StopReason::superseded);
  sessions_.leave("s", number);
  sessions_.enter("t", third);
  EXPECT_FALSE(second.requested());
  const auto last = sessions_.enter("s", third);
  EXPECT_EQ(second.reason(), StopReason::superseded) << "it was still the latest one";
  sessions_.leave("s", last);
  sessions_.enter("s", first);
  EXPECT_FALSE(third.requested()) << "it has left";
  sessions_.enter("", second);
  sessions_.enter("", third);
  EXPECT_FALSE(third.requested());
}

TEST_F(JobPartsTest, OneThreadAloneMayEndAJobAndTheOthersWaitForIt) {
  const auto one = job("a", {}, Row::written);
  board_.add(one);
  const auto claim = board_.claim_end(*one);
  ASSERT_TRUE(claim);
  EXPECT_TRUE(claim->has_row);
  EXPECT_FALSE(board_.start(*one)) << "it does not run any more";
  std::atomic<bool> is_over{false};
  std::thread other([&] {
    EXPECT_FALSE(board_.claim_end(*one));
    EXPECT_FALSE(board_.begin_row(*one));
    EXPECT_TRUE(is_over);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  is_over = true;
  board_.complete(*one, claim->record, std::nullopt, nullptr);
  other.join();
  EXPECT_TRUE(board_.has_ended(*one));
  EXPECT_FALSE(board_.has("a"));
  EXPECT_TRUE(board_.wait_until_over(*one, Clock::now()));
}

TEST_F(JobPartsTest, AThreadThatOnlyTriesToEndAJobDoesNotWaitForAnother) {
  const auto one = job("a");
  board_.add(one);
  EXPECT_TRUE(board_.begin_row(*one));
  EXPECT_FALSE(board_.try_claim_end(*one)) << "its row is being written";
  board_.row_written(*one);
  const auto claim = board_.try_claim_end(*one);
  ASSERT_TRUE(claim);
  EXPECT_TRUE(claim->has_row);
  EXPECT_FALSE(board_.try_claim_end(*one)) << "its end is being stored";
  board_.release(*one);
  EXPECT_FALSE(board_.try_claim_end(*one));
}

TEST_F(JobPartsTest, NobodyEndsAJobWhileItsRowIsBeingWritten) {
  const auto one = job("a");
  board_.add(one);
  EXPECT_EQ(board_.find("a"), nullptr);
  EXPECT_TRUE(board_.begin_row(*one));
  EXPECT_EQ(board_.find("a"), one);
  EXPECT_TRUE(board_.leased_jobs().empty()) << "the store may not have it yet";
  std::atomic<bool> is_written{false};
  std::thread other([&] {
    EXPECT_TRUE(board_.claim_end(*one)->has_row);
    EXPECT_TRUE(is_written);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  is_written = true;
  board_.row_written(*one);
  other.join();
}

TEST_F(JobPartsTest, AJobWithoutARowIsReleasedIfItWaitsAndStoppedIfItRuns) {
  const auto waits = job("waits");
  const auto runs = job("runs");
  for (const auto& one : {waits, runs}) board_.add(one);
  EXPECT_FALSE(board_.start(*runs)->record) << "the store is told nothing";
  EXPECT_TRUE(board_.row_failed(*waits));
  EXPECT_FALSE(board_.row_failed(*runs));
  EXPECT_TRUE(waits->token.requested());
  EXPECT_TRUE(runs->token.requested());
  EXPECT_FALSE(board_.has("waits"));
  EXPECT_TRUE(board_.has("runs"));
  EXPECT_FALSE(board_.has_ended(*waits)) << "it is released";
  const auto overdue = board_.overdue(*runs, Clock::now() + Watchdog::patience);
  ASSERT_TRUE(overdue) << "its worker is replaced if it does not stop";
  EXPECT_EQ(overdue->reason, StopReason::cancelled);
}

TEST_F(JobPartsTest, TheBoardShowsProgressThatNeverFallsAndTellsTheKeeperWhatIsNew) {
  Computation computation;
  computation.mesh = "m";
  const auto one = job("a", std::move(computation), Row::written);
  board_.add(one);
  EXPECT_TRUE(board_.is_mesh_in_use("m"));
  EXPECT_FALSE(board_.is_mesh_in_use("n"));
  EXPECT_FALSE(board_.leased_jobs().at(0).progress) << "it waits";
  EXPECT_EQ(board_.start(*one)->record->attempts, 1);
  board_.set_progress(*one, 0.5, "half");
  board_.set_progress(*one, 0.25, "next");
  auto leased = board_.leased_jobs().at(0);
  EXPECT_EQ(leased.progress->fraction, 0.5);
  EXPECT_EQ(leased.progress->stage, "next");
  one->shared_version = leased.version;
  EXPECT_FALSE(board_.leased_jobs().at(0).progress);
  board_.set_partial(*one, "{}", false);
  EXPECT_FALSE(board_.leased_jobs().at(0).progress) << "it is told with the next change";
  board_.set_partial(*one, "{\"a\":1}", true);
  EXPECT_EQ(board_.leased_jobs().at(0).progress->partial, "{\"a\":1}");
  std::uint64_t version = 0;
  EXPECT_EQ(board_.wait_for_change(*one, version, 60)->record.state, JobState::running);
  const auto seen = version;
  EXPECT_TRUE(board_.wait_for_change(*one, version, 0));
  EXPECT_EQ(version, seen);
  board_.release(*one);
  EXPECT_FALSE(board_.wait_for_change(*one, version, 60));
}

TEST_F(JobPartsTest, InASharedStoreMemoryKnowsTheStatusOfRunningJobsAlone) {
  JobBoard shared(true);
  const auto one = job("a", {}, Row::written);
  shared.add(one);
  EXPECT_FALSE(shared.status_in_memory("a"));
  shared.start(*one);
  EXPECT_FALSE(shared.status_in_memory("a")) << "the store is told of its start now";
  shared.set_running(*one);
  EXPECT_TRUE(shared.status_in_memory("a"));
  shared.claim_end(*one);
  EXPECT_FALSE(shared.status_in_memory("a"));
  shared.set_running(*one);
  EXPECT_FALSE(shared.status_in_memory("a")) << "it stays ending";
  EXPECT_FALSE(shared.status_in_memory("b"));
}

TEST_F(JobPartsTest, AComputationIsOverdueASecondAfterItsDeadlineItsEndOrItsClientsLeaving) {
  const auto now = Clock::now();
  const auto later = now + std::chrono::seconds(3);
  const auto runs = job("runs");
  EXPECT_FALSE(board_.overdue(*runs, later));
  EXPECT_EQ(board_.overdue(*runs, runs->due + Watchdog::patience)->reason, StopReason::deadline);
  EXPECT_FALSE(board_.overdue(*runs, runs->due)) << "it has a second to stop";
  board_.begin_row(*runs);
  EXPECT_FALSE(board_.overdue(*runs, runs->due + Watchdog::patience)) << "its row is being written";
  board_.row_written(*runs);
  board_.set_client_left(*runs);
  EXPECT_EQ(runs->token.reason(), StopReason::cancelled);
  EXPECT_FALSE(board_.overdue(*runs, now));
  EXPECT_EQ(board_.overdue(*runs, later)->reason, StopReason::cancelled);
  const auto ended = job("ended");
  board_.claim_end(*ended);
  EXPECT_FALSE(board_.overdue(*ended, ended->due + Watchdog::patience)) << "its end is being stored";
  board_.release(*ended);
  EXPECT_EQ(board_.overdue(*ended, later)->reason, StopReason::cancelled);
}

TEST_F(JobPartsTest, AReportHasItsTimeFromWhenTheSearchHasEnded) {
  const Clock::time_point due(std::chrono::hours(1));
  const std::chrono::milliseconds long_search(900);
  std::optional<Clock::time_point> told;
  bool client_has_gone = false;
  Watchdog::Entry entry{{{}, due, [&] { return client_has_gone; }, {}, [&](Clock::time_point now) { told = now; }}};
  const auto& token = entry.watch.token;
  entry.check(due - long_search);
  EXPECT_FALSE(token.requested());
  entry.check(due);
  EXPECT_EQ(token.reason(), StopReason::deadline);
  ASSERT_TRUE(token.resume(StopReason::deadline));
  entry.check(due + long_search);
  EXPECT_EQ(told, due + long_search);
  entry.check(due + long_search + Watchdog::report_time - Watchdog::period);
  EXPECT_FALSE(token.requested()) << "half a second has not passed since the search has ended";
  EXPECT_FALSE(entry.is_overdue(due + Watchdog::patience));
  entry.check(due + long_search + Watchdog::report_time);
  EXPECT_EQ(token.reason(), StopReason::deadline);
  EXPECT_TRUE(entry.is_overdue(due + long_search + Watchdog::patience));
  ASSERT_TRUE(token.resume(StopReason::deadline));
  entry.check(due + long_search + Watchdog::patience);
  EXPECT_TRUE(token.requested()) << "its time is over";

  Watchdog::Entry left{{{}, due, [&] { return client_has_gone; }}};
  left.check(due);
  ASSERT_TRUE(left.watch.token.resume(StopReason::deadline));
  left.check(due + long_search);
  client_has_gone = true;
  left.check(due + long_search + Watchdog::period);
  EXPECT_EQ(left.watch.token.reason(), StopReason::cancelled);
  EXPECT_FALSE(left.is_overdue(due + long_search + Watchdog::patience));
  EXPECT_TRUE(left.is_overdue(due + long_search + Watchdog::period + Watchdog::patience));

  const auto runs = job("runs");
  runs->resumed_at = runs->due + long_search;
  EXPECT_FALSE(board_.overdue(*runs, runs->due + Watchdog::patience));
  EXPECT_TRUE(board_.overdue(*runs, runs->due + long_search + Watchdog::patience));
}

TEST_F(JobPartsTest, ASchedulerThatRefusesTakesNoJobAndStopsThoseThatWait) {
  options_.workers = 3;
  EXPECT_EQ(scheduler_.missing_workers(WorkerKind::foreground), 4U) << "one is for interactive jobs";
  EXPECT_EQ(scheduler_.missing_workers(WorkerKind::background), 3U);
  const auto one = job("a", {}, Row::written);
  scheduler_.admit(one);
  EXPECT_EQ(scheduler_.idle_workers()->foreground, 2U);
  EXPECT_EQ(scheduler_.idle_workers()->background, 3U);
  EXPECT_TRUE(scheduler_.adopt(job("b", {}, Row::written)));
  EXPECT_FALSE(scheduler_.adopt(job("b", {}, Row::written))) << "it is known";
  EXPECT_EQ(scheduler_.waiting(), 2U);
  scheduler_.forget(*one);
  EXPECT_EQ(scheduler_.waiting(), 1U);
  scheduler_.refuse();
  EXPECT_FALSE(scheduler_.idle_workers());
  EXPECT_FALSE(scheduler_.adopt(job("c", {}, Row::written)));
  EXPECT_THROW(scheduler_.admit(job("d")), Error);
  ASSERT_EQ(scheduler_.stopped_jobs().size(), 1U);
  EXPECT_EQ(scheduler_.waiting_jobs().at(0)->token.reason(), StopReason::shutdown);
  scheduler_.end();
  EXPECT_FALSE(scheduler_.take(scheduler_.add_seat()));
  EXPECT_EQ(scheduler_.missing_workers(WorkerKind::foreground), 0U);
  EXPECT_EQ(scheduler_.missing_workers(WorkerKind::background), 0U);
}

TEST_F(JobPartsTest, JobsInTheBackgroundTakeNoWorkerFromOthersAndOthersNoneFromThem) {
  options_.workers = 1;
  scheduler_.admit(job("quiet", of_priority(Priority::background), Row::written));
  scheduler_.admit(job("normal", of_priority(Priority::normal), Row::written));
  EXPECT_EQ(scheduler_.idle_workers()->foreground, 0U);
  EXPECT_EQ(scheduler_.idle_workers()->background, 0U);
  auto& quiet = start_job(WorkerKind::background);
  auto& normal = start_job(WorkerKind::foreground);
  EXPECT_EQ(id_of(quiet.job), "quiet");
  EXPECT_EQ(id_of(normal.job), "normal");
  EXPECT_EQ(scheduler_.running(), 2U);
  scheduler_.admit(job("quiet too", of_priority(Priority::background), Row::written));
  scheduler_.admit(job("normal too", of_priority(Priority::normal), Row::written));
  scheduler_.admit(job("drag", of_priority(Priority::interactive), Row::written));
  EXPECT_EQ(scheduler_.waiting(Priority::background), 1U);
  auto& drag = start_job(WorkerKind::foreground);
  EXPECT_EQ(id_of(drag.job), "drag") << "one more may run than there are workers";
  scheduler_.leave(drag);
  scheduler_.leave(normal);
  ASSERT_TRUE(scheduler_.take(normal));
  EXPECT_EQ(id_of(normal.job), "normal too");
  scheduler_.leave(quiet);
  ASSERT_TRUE(scheduler_.take(quiet));
  EXPECT_EQ(id_of(quiet.job), "quiet too");
}

TEST_F(JobPartsTest, AJobThatDoesNotStopIsAbandonedOnceAndLateUntilItsComputationReturns) {
  Computation late;
  late.deadline = -60;
  scheduler_.admit(job("a", std::move(late), Row::written));
  auto& seat = scheduler_.add_seat();
  ASSERT_TRUE(scheduler_.take(seat));
  for (const bool is_first : {true, false}) {
    const auto jobs = scheduler_.abandon_late_jobs();
    ASSERT_EQ(jobs.size(), 1U) << "the thread that was to end it may have failed";
    EXPECT_EQ(jobs[0].since.reason, StopReason::deadline);
    EXPECT_EQ(jobs[0].is_abandoned, is_first);
    EXPECT_EQ(scheduler_.abandoned(), 1U);
    EXPECT_EQ(scheduler_.running(), 0U);
  }
  scheduler_.set_computed(seat);
  EXPECT_TRUE(scheduler_.abandon_late_jobs().empty());
  EXPECT_TRUE(scheduler_.leave(seat));
}

/// A journal over a store whose writing can fail.
class JournalTest : public ::testing::Test {
 protected:
  JournalTest() {
    store_.hooked_jobs.at_finish = [this](const auto&, const store::Result* result) { fail(result); };
  }
  void fail(const store::Result* result) const {
    if (!refuses_all_ && !(refuses_results_ && result)) return;
    if (is_away_) throw store::StoreUnavailable("No.");
    throw store::StoreFull("No.");
  }
  store::JobRecord added(const std::string& id) {
    store::JobRecord record;
    record.id = id;
    record.kind = "geodesics";
    journal_.add(record, {});
    return record;
  }

  const testing::TemporaryFolder folder_;
  TestStore store_{folder_ / "data"};
  QueueOptions options_;
  std::vector<std::string> log_;
  Journal journal_{store_, options_, json::write_problem, [this](const std::string& line) { log_.push_back(line); }};
  bool is_away_ = false;  ///< whether what refuses is a store that does not answer, not one that is full
  bool refuses_results_ = false;
  bool refuses_all_ = false;
};

TEST_F(JournalTest, AJobWhoseResultTheStoreRefusesHasFailedWithTheReason) {
  auto record = added("a");
  refuses_results_ = true;
  const Result result{"text/plain", {}, "x"};
  journal_.set_end(record, JobState::successful, {});
  record.finished = 1000;
  record.expires = 2000;
  EXPECT_TRUE(journal_.end(record, &result));
  EXPECT_EQ(record.state, JobState::failed);
  EXPECT_EQ(record.finished, 1000) << "the computation ended then";
  EXPECT_EQ(record.expires, 2000);
  EXPECT_EQ(record.error_status, 507);
  EXPECT_EQ(store_.jobs().job("a")->state, JobState::failed);
  EXPECT_FALSE(journal_.has_refused_ends());
  EXPECT_EQ(log_.size(), 1U);
}

TEST_F(JournalTest, AnEndThatTheStoreRefusesIsWrittenLater) {
  auto record = added("a");
  refuses_all_ = true;
  options_.retention = 10;
  journal_.set_end(record, JobState::dismissed, {});
  EXPECT_EQ(record.expires, record.finished + 10'000);
  EXPECT_TRUE(journal_.end(record, nullptr));
  EXPECT_EQ(journal_.refused_end("a")->state, JobState::dismissed);
  journal_.write_refused_ends();
  EXPECT_TRUE(journal_.has_refused_ends()) << "the store refuses it still";
  EXPECT_EQ(log_.size(), 1U) << "and that is not news";
  refuses_all_ = false;
  journal_.write_refused_ends();
  EXPECT_FALSE(journal_.refused_end("a"));
  EXPECT_EQ(store_.jobs().job("a")->state, JobState::dismissed);
  EXPECT_EQ(log_.size(), 2U);
}

TEST_F(JournalTest, InASharedStoreAJobWhoseEndCannotBeStoredIsAnotherServers) {
  store_.own_leases.emplace(store_.jobs());
  auto record = added("a");
  refuses_all_ = true;
  is_away_ = true;
  journal_.set_end(record, JobState::failed, problem::Problem{"karcher.weights", "Bad.", {}, {}, {}});
  EXPECT_EQ(record.error_status, 422);
  EXPECT_FALSE(journal_.end(record, nullptr));
  EXPECT_FALSE(journal_.has_refused_ends());
  is_away_ = false;
  EXPECT_TRUE(journal_.end(record, nullptr));
  EXPECT_TRUE(journal_.has_refused_ends());
  refuses_all_ = false;
  record.id = "unknown";
  EXPECT_FALSE(journal_.end(record, nullptr)) << "another server has removed it";
}

TEST_F(JournalTest, AStoreOfOneServerThatIsAwayRefusesAnEndAsAFullOneDoes) {
  auto record = added("a");
  refuses_all_ = is_away_ = true;
  journal_.set_end(record, JobState::dismissed, {});
  EXPECT_TRUE(journal_.end(record, nullptr)) << "no other server runs the job";
  EXPECT_TRUE(journal_.has_refused_ends());
  EXPECT_EQ(log_.size(), 1U);
}

TEST_F(JournalTest, AStartThatTheStoreDoesNotTakeIsNoReasonNotToRun) {
  auto record = added("a");
  record.state = JobState::running;
  EXPECT_TRUE(journal_.update(record));
  EXPECT_EQ(store_.jobs().job("a")->state, JobState::running);
  store_.hooked_jobs.at_update = [](const auto&) { throw store::StoreFull("No."); };
  EXPECT_TRUE(journal_.update(record));
}

TEST_F(JournalTest, ARequestIsRemovedIfItsJobIsNotAdded) {
  store::JobRecord record;
  record.id = "a";
  record.idempotency_key = "key";
  const RequestOfJob request{{"POST", "/v1/x", {}, "text/plain", {}}, "body"};
  journal_.add(record, request);
  EXPECT_EQ(store_.blobs().job_request("a").body, "body");
  record.id = "b";
  EXPECT_THROW(journal_.add(record, request), KeyIsUsed);
  EXPECT_FALSE(store_.blobs().has_request("b"));
}

}  // namespace
}  // namespace supple::jobs
