#include "supple/problem/edit_distance.h"

#include <gtest/gtest.h>

namespace supple::problem {
namespace {

TEST(EditDistance, CountsInsertionsDeletionsAndSubstitutions) {
  EXPECT_EQ(edit_distance("mesh", "mesh"), 0U);
  EXPECT_EQ(edit_distance("mesh", "mess"), 1U);
  EXPECT_EQ(edit_distance("mesh", "meshes"), 2U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("ab", "ba"), 2U) << "letters that are exchanged are two substitutions";
  EXPECT_EQ(edit_distance("", "four"), 4U);
  EXPECT_EQ(edit_distance("four", ""), 4U);
}

}  // namespace
}  // namespace supple::problem
