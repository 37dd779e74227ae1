#include "supple/http/message.h"

#include <gtest/gtest.h>

namespace supple::http {
namespace {

TEST(Message, FindsHeadersInAnyCaseAndJoinsRepeatedOnes) {
  Request request;
  request.headers = {{"prefer", "wait=1"}, {"Accept", "x/y"}, {"PREFER", "respond-async"}};
  EXPECT_EQ(request.header("Prefer"), "wait=1, respond-async");
  EXPECT_EQ(request.header("If-None-Match"), "");
}

TEST(Message, ReadsAMediaTypeWithoutItsParameters) {
  EXPECT_EQ(media_type(" Application/JSON ; charset=utf-8"), "application/json");
}

TEST(Message, ChoosesTheMediaTypeOfHighestQuality) {
  const std::vector<std::string_view> offered{"application/json", "application/octet-stream"};
  EXPECT_EQ(negotiate("", offered), "application/json");
  EXPECT_EQ(negotiate("*/*", offered), "application/json");
  EXPECT_EQ(negotiate("application/octet-stream", offered), "application/octet-stream");
  EXPECT_EQ(negotiate("application/json;q=0.5, application/*", offered), "application/octet-stream");
  EXPECT_EQ(negotiate("application/json;q=0, */*;q=0.1", offered), "application/octet-stream");
  EXPECT_EQ(negotiate("text/html", offered), std::nullopt);
}

TEST(Message, ReadsPreferences) {
  const auto preference = parse_preference("handling=lenient, respond-async, Wait=2.5", 10);
  EXPECT_TRUE(preference.respond_async);
  EXPECT_EQ(preference.wait, 2.5);
  EXPECT_FALSE(parse_preference("", 10).wait);
  for (const char* header : {"wait=11", "wait=-1", "wait=x", "wait=", "wait=nan", "wait=1e3"}) {
    EXPECT_THROW(parse_preference(header, 10), Error) << header;
  }
}

}  // namespace
}  // namespace supple::http
