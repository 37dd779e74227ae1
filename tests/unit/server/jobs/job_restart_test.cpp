#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "job_queue_fixture.h"

namespace supple::jobs {
namespace {

TEST_F(JobQueueTest, CallsJobsOfAnEarlierProcessInterrupted) {
  store::JobRecord job;
  job.id = "lost";
  store_->jobs().add_job(job);
  const auto status = queue().status("lost");
  EXPECT_EQ(status.record.state, JobState::failed);
  EXPECT_NE(status.record.error.find("job.interrupted"), std::string::npos);
}

TEST_F(JobQueueTest, GoesOnWithTheJobsOfAProcessThatWasToldToEnd) {
  remake_ = echo;
  const auto running = queue().submit(endless(), request("running")).record;
  wait_until_started();
  std::vector<std::string> ids{running.id};
  for (const char* body : {"a", "b", "c"}) {
    auto waiting = answering("of the first process");
    waiting.client = body;
    waiting.session = body;
    ids.push_back(queue().submit(std::move(waiting), request(body)).record.id);
  }
  const auto begun = queue().status(running.id).record;
  EXPECT_EQ(begun.state, JobState::running);
  EXPECT_EQ(begun.attempts, 1);
  queue().shut_down(0.02);
  const auto left = store_->jobs().unfinished_jobs();
  ASSERT_EQ(left.size(), 4U);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    EXPECT_EQ(left[i].id, ids[i]);
    EXPECT_EQ(left[i].state, JobState::accepted);
    EXPECT_EQ(left[i].attempts, 0) << "an end in good order is no failed attempt";
  }
  restart();
  std::int64_t last = 0;
  for (const auto& [id, body] : std::vector<std::pair<std::string, std::string>>{
           {ids[0], "running"}, {ids[1], "a"}, {ids[2], "b"}, {ids[3], "c"}}) {
    const auto record = wait_until_finished(id).record;
    EXPECT_EQ(record.state, JobState::successful) << record.error;
    EXPECT_EQ(queue().result(id).body.text(), body);
    EXPECT_GE(record.started, last) << "in the old order";
    EXPECT_EQ(record.client, store_->jobs().job(id)->client);
    last = record.started;
  }
  EXPECT_EQ(store_->jobs().job(ids[1])->client, "a");
  EXPECT_EQ(store_->jobs().job(ids[1])->session, "a");
  EXPECT_TRUE(fs::is_empty(folder_ / "requests"));
}

TEST_F(JobQueueTest, TellsOfAJobInTheQueueWhatItsRequestDoesWrongNow) {
  remake_ = [](const store::JobRecord&, const store::StoredRequest&, const Execution&) -> Computation {
    throw Error("model.not_found", "It has gone.");
  };
  leave_running("j", 1, "x");
  const auto record = wait_until_finished("j").record;
  EXPECT_EQ(record.error_status, 404);
  EXPECT_NE(record.error.find("model.not_found"), std::string::npos);
}

TEST_F(JobQueueTest, LeavesNoJobToTheNextProcessForWhatItsComputationThrows) {
  remake_ = echo;
  const auto failing = [](const Execution&) -> store::Result { throw Error("server.shutting_down", "Not this one."); };
  const auto id = queue().submit(computation(failing), request("x")).record.id;
  const auto record = wait_until_finished(id).record;
  EXPECT_EQ(record.state, JobState::failed);
  EXPECT_EQ(record.error_status, 503);
}

TEST_F(JobQueueTest, GivesAJobUpThatTheProcessEndedInTooOften) {
  remake_ = echo;
  leave_running("twice", 2, "twice");
  leave_running("thrice", 3, "thrice");
  EXPECT_EQ(wait_until_finished("twice").record.state, JobState::successful);
  EXPECT_EQ(store_->jobs().job("twice")->attempts, 3);
  const auto record = queue().status("thrice").record;
  EXPECT_EQ(record.state, JobState::failed);
  EXPECT_NE(record.error.find("job.given_up"), std::string::npos);
  EXPECT_NE(record.error.find("ended 3 times"), std::string::npos);
  EXPECT_FALSE(store_->blobs().has_request("thrice"));
}

TEST_F(JobQueueTest, CountsStartsAnewOnceAJobHasSavedSomethingForTheNext) {
  std::atomic<int> attempts{0};
  remake_ = [&](const store::JobRecord& record, const store::StoredRequest&, const Execution&) {
    return computation([this, &attempts, id = record.id](const Execution& execution) {
      if (id == "saves") execution.progress->saved();
      attempts += store_->jobs().job(id)->attempts;
      return store::Result{"text/plain", {}, "x"};
    });
  };
  leave_running("saves", 2, "x");
  EXPECT_EQ(wait_until_finished("saves").record.state, JobState::successful);
  EXPECT_EQ(attempts, 1) << "the store knows it while the job runs";
  EXPECT_EQ(store_->jobs().job("saves")->attempts, 1);
}

TEST_F(JobQueueTest, NotesInTheStoreThatAJobBegins) {
  const auto waited = queue().run_within(endless(), 0.1, {});
  ASSERT_FALSE(waited.result);
  EXPECT_EQ(store_->jobs().job(waited.job.record.id)->state, JobState::running);
  queue().remove(waited.job.record.id);
  const auto id = queue().submit(endless()).record.id;
  wait_until_started(2);
  const auto record = *store_->jobs().job(id);
  EXPECT_EQ(record.state, JobState::running);
  EXPECT_EQ(record.attempts, 1);
  EXPECT_GT(record.started, 0);
}

TEST_F(JobQueueTest, RunsLastAttemptsOneAtATimeBesideOthers) {
  options_.workers = 3;
  std::atomic<int> suspects{0};
  std::atomic<int> most{0};
  std::atomic<int> others{0};
  remake_ = [&](const store::JobRecord& record, const store::StoredRequest&, const Execution&) {
    auto& running = record.attempts == 2 ? suspects : others;
    return computation([&](const Execution&) {
      const int now = ++running;
      if (&running == &suspects && now > most) most = now;
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
      --running;
      return store::Result{"text/plain", {}, "x"};
    });
  };
  for (const char* id : {"a", "b", "c"}) leave_running(id, 2, "x");
  leave_running("d", 1, "x");
  for (const char* id : {"a", "b", "c", "d"})
    EXPECT_EQ(wait_until_finished(id).record.state, JobState::successful) << id;
  EXPECT_EQ(most, 1);
}

TEST_F(JobQueueTest, KeepsNoRequestOfWhatNeverBecameAJob) {
  options_.max_queue = 0;
  EXPECT_EQ(code_of([&] { queue().submit(answering("x"), request("x")); }), "job.queue_full");
  options_.max_queue = 10;
  queue_.reset();
  EXPECT_TRUE(queue().run_within(answering("x"), 30, {}, request("x")).result);
  EXPECT_TRUE(fs::is_empty(folder_ / "requests"));
  EXPECT_TRUE(store_->jobs().jobs({}, 10, "").empty());
}

TEST_F(JobQueueTest, KeepsTheDismissalOfAJobThatEndsWithTheProcess) {
  remake_ = echo;
  const auto id = queue().submit(endless(), request("x")).record.id;
  wait_until_started();
  queue().remove(id);
  restart();
  EXPECT_EQ(queue().status(id).record.state, JobState::dismissed);
}

TEST_F(JobQueueTest, LetsRunningJobsFinishWithinTheGrace) {
  const auto id = queue()
                      .submit(computation([this](const Execution&) {
                        ++started_;
                        std::this_thread::sleep_for(std::chrono::milliseconds(50));
                        return store::Result{"text/plain", {}, "late"};
                      }))
                      .record.id;
  wait_until_started();
  queue().shut_down(30);
  EXPECT_EQ(store_->blobs().job_result(id).body.text(), "late");
}

TEST_F(JobQueueTest, InterruptsWhatDoesNotFinishWithinTheGrace) {
  const auto running = queue().submit(endless()).record.id;
  wait_until_started();
  const auto waiting = queue().submit(answering("x")).record.id;
  queue().shut_down(0.02);
  for (const auto& id : {running, waiting}) {
    EXPECT_NE(store_->jobs().job(id)->error.find("job.interrupted"), std::string::npos);
  }
  EXPECT_EQ(code_of([&] { queue().submit(answering("x")); }), "server.shutting_down");
  EXPECT_EQ(code_of([&] { queue().run_now(answering("x"), {}); }), "server.shutting_down");
}

}  // namespace
}  // namespace supple::jobs
