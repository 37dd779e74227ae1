#include "supple/log/context.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

namespace supple::log {
namespace {

TEST(LogContext, IsThereWhileItLastsTheOutermostFirst) {
  EXPECT_EQ(context_text(), "");
  {
    const Context request("request", "0f");
    EXPECT_EQ(context_text(), "request=0f ");
    {
      const Context job("job", "ab");
      EXPECT_EQ(context_text(), "request=0f job=ab ");
    }
    EXPECT_EQ(context_text(), "request=0f ");
  }
  EXPECT_EQ(context_text(), "");
}

TEST(LogContext, IsItsThreadsAlone) {
  const Context mine("request", "0f");
  std::string others = "not looked at";
  std::thread([&] { others = context_text(); }).join();
  EXPECT_EQ(others, "");
  std::thread([&] {
    const Context context("job", "ab");
    others = context_text();
  }).join();
  EXPECT_EQ(others, "job=ab ");
  EXPECT_EQ(context_text(), "request=0f ");
}

TEST(LogContext, EndsWithWhateverIsThrown) {
  try {
    const Context context("request", "0f");
    throw std::runtime_error("no");
  } catch (const std::runtime_error&) {
    EXPECT_EQ(context_text(), "");
  }
}

}  // namespace
}  // namespace supple::log
