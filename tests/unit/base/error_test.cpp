#include "supple/base/error.h"

#include <gtest/gtest.h>

namespace supple {
namespace {

TEST(Error, CarriesItsCodeSentenceAndDetails) {
  const Error error("mesh.degenerate_face", "2 faces are degenerate.",
                    {{"face 3", "repeats a vertex"}, {"face 8", "x"}});
  EXPECT_EQ(error.code(), "mesh.degenerate_face");
  EXPECT_STREQ(error.what(), "2 faces are degenerate.");
  ASSERT_EQ(error.details().size(), 2u);
  EXPECT_EQ(error.details()[0].where, "face 3");
  EXPECT_EQ(error.details()[0].message, "repeats a vertex");
}

TEST(Error, IsCaughtAsAStandardException) {
  EXPECT_THROW(throw Error("a.b", "sentence"), std::runtime_error);
  EXPECT_TRUE(Error("a.b", "sentence").details().empty());
}

}  // namespace
}  // namespace supple
