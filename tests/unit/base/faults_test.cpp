#include "supple/base/faults.h"

#include <gtest/gtest.h>

namespace supple {
namespace {

Error error_of(const Faults& faults, const std::string& whole = "The input") {
  try {
    faults.throw_if_any("some.code", whole);
  } catch (const Error& error) {
    return error;
  }
  return {"nothing", "nothing was thrown"};
}

TEST(Faults, ThrowNothingWhereThereAreNone) {
  Faults faults;
  faults.require(true, "a", "must not be reported");
  EXPECT_FALSE(faults.any());
  EXPECT_NO_THROW(faults.throw_if_any("some.code"));
}

TEST(Faults, NameEveryPlaceAndSayHowManyMoreThereAre) {
  Faults faults;
  faults.require(false, "points/3", "must be finite");
  EXPECT_STREQ(error_of(faults).what(), "points/3: must be finite");
  faults.add("points/4", "must be positive");
  faults.add("points/5", "must be small");
  const Error error = error_of(faults);
  EXPECT_EQ(error.code(), "some.code");
  EXPECT_STREQ(error.what(), "points/3: must be finite (and 2 more)");
  ASSERT_EQ(error.details().size(), 3U);
  EXPECT_EQ(error.details()[1].where, "points/4");
  EXPECT_EQ(error.details()[1].message, "must be positive");
}

TEST(Faults, KeepTheFirstTwentyAndCountAll) {
  Faults faults;
  for (int i = 0; i < 50; ++i) faults.add(std::to_string(i), "is wrong");
  const Error error = error_of(faults);
  EXPECT_EQ(faults.total(), 50U);
  ASSERT_EQ(error.details().size(), 20U);
  EXPECT_EQ(error.details().back().where, "19");
  EXPECT_STREQ(error.what(), "0: is wrong (and 49 more)");
}

TEST(Faults, NameTheWholeWhereNoPlaceIsGiven) {
  Faults faults;
  faults.add("", "must be an object");
  EXPECT_STREQ(error_of(faults, "The body").what(), "The body: must be an object");
}

}  // namespace
}  // namespace supple
