#include "job_events.h"

#include <gtest/gtest.h>

#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "supple/store/store_error.h"

namespace supple::routes {
namespace {

using store::JobState;

class Recorder final : public http::StreamWriter {
 public:
  bool write(std::string_view text) override {
    this->text += text;
    return true;
  }
  bool client_gone() override { return false; }
  std::string text;
};

jobs::JobStatus status_in(JobState state) {
  jobs::JobStatus status;
  status.record.id = "0123456789abcdef0123456789abcdef";
  status.record.state = state;
  return status;
}

/// What a stream sends whose job shows these states, or fails so, one after the other.
struct Step {
  JobState state = JobState::running;
  std::exception_ptr failure{};
};
std::string stream_of(const std::vector<Step>& steps) {
  std::size_t next = 0;
  Recorder out;
  follow_job({.wait_for_change =
                  [&](std::uint64_t& version, double) {
                    const auto& step = steps.at(next++);
                    if (step.failure) std::rethrow_exception(step.failure);
                    ++version;
                    return status_in(step.state);
                  },
              .may_follow = [&] { return next < steps.size(); },
              .period_seconds = 0.001},
             out);
  EXPECT_EQ(next, steps.size()) << "the stream ended before";
  return out.text;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(JobEvents, TheRemainingTimeFollowsFromTheProgressOfARunningJob) {
  auto status = status_in(JobState::running);
  status.record.started = 1'000'000;
  status.progress = 0.25;
  EXPECT_DOUBLE_EQ(estimated_remaining_seconds(status, 1'010'000).value_or(0), 30);
  EXPECT_NE(write_job(status).find("\"remaining_seconds\":"), std::string::npos);
  EXPECT_EQ(estimated_remaining_seconds(status, 900'000), 0) << "the clock was set";
  status.progress = 0.02;
  EXPECT_FALSE(estimated_remaining_seconds(status, 1'010'000)) << "too little is known";
  EXPECT_NE(write_job(status).find("\"remaining_seconds\":null"), std::string::npos);
  for (const auto state : {JobState::accepted, JobState::successful, JobState::failed, JobState::dismissed}) {
    auto other = status_in(state);
    other.progress = 0.5;
    EXPECT_FALSE(estimated_remaining_seconds(other, 1'010'000));
  }
}

TEST(JobEvents, AJobIsFollowedUntilItIsFinished) {
  const auto text = stream_of({{JobState::accepted}, {JobState::running}, {JobState::successful}});
  EXPECT_EQ(count(text, "event: progress\n"), 2U) << text;
  EXPECT_TRUE(text.find("event: finished\n") > text.rfind("event: progress\n")) << text;
}

TEST(JobEvents, AStoreThatIsAwayForAWhileDoesNotEndTheStream) {
  const auto away = std::make_exception_ptr(store::StoreUnavailable("No."));
  const auto text =
      stream_of({{JobState::running}, {JobState::running, away}, {JobState::running, away}, {JobState::successful}});
  EXPECT_EQ(count(text, "event: finished\n"), 1U) << text;
  EXPECT_EQ(count(text, ": the job cannot be read now (store.unavailable)\n\n"), 1U) << "told once: " << text;
}

TEST(JobEvents, AJobThatIsRemovedEndsTheStreamWithoutAnEvent) {
  const auto removed = std::make_exception_ptr(store::JobNotFound("0123456789abcdef0123456789abcdef"));
  const auto text = stream_of({{JobState::running}, {JobState::running, removed}});
  EXPECT_EQ(count(text, "event: "), 1U) << text;
  EXPECT_EQ(count(text, "cannot be read"), 0U) << text;
}

}  // namespace
}  // namespace supple::routes
