#include "supple/dataset/merge.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "sample_data.h"
#include "supple/base/error.h"
#include "supple/dataset/dataset_file.h"
#include "supple/dataset/journal.h"
#include "support/temporary_folder.h"

namespace supple::dataset {
namespace {

std::string code_of_merging(std::vector<Dataset> parts) {
  try {
    merge(std::move(parts));
  } catch (const Error& error) {
    return error.code();
  }
  return {};
}

TEST(Merge, OfAllShardsIsTheDataSetMadeWithoutShards) {
  const Dataset merged =
      merge({sample_dataset({0, 10, 2, 3}), sample_dataset({0, 10, 0, 3}), sample_dataset({0, 10, 1, 3})});
  const Dataset whole = sample_dataset({0, 10, 0, 1});
  EXPECT_EQ(merged.recipe, whole.recipe);
  EXPECT_EQ(merged.selection, whole.selection);
  EXPECT_EQ(all_values(merged.designs), all_values(whole.designs));
}

TEST(Merge, JoinsConsecutiveStretchesOfTheSequence) {
  const Dataset merged = merge({sample_dataset({6, 4, 0, 1}), sample_dataset({0, 6, 0, 1})});
  EXPECT_EQ(merged.selection, (Selection{0, 10, 0, 1}));
  EXPECT_EQ(all_values(merged.designs), all_values(sample_dataset({0, 10, 0, 1}).designs));
}

TEST(Merge, RefusesPartsOfDifferentRecipes) {
  Dataset other = sample_dataset({0, 10, 1, 2});
  other.recipe.set("tolerance", 1e-8, "1");
  EXPECT_EQ(code_of_merging({sample_dataset({0, 10, 0, 2}), other}), "dataset.different_recipe");
}

TEST(Merge, RefusesADesignThatIsInTwoParts) {
  EXPECT_EQ(code_of_merging({sample_dataset({0, 4, 0, 1}), sample_dataset({3, 4, 0, 1})}), "dataset.duplicate_design");
}

TEST(Merge, RefusesMissingDesignsUnlessTheyAreAllowed) {
  const std::vector<Dataset> parts{sample_dataset({0, 9, 0, 3}), sample_dataset({0, 9, 2, 3})};
  EXPECT_EQ(code_of_merging(parts), "dataset.missing_designs");
  const Dataset merged = merge(parts, true);
  EXPECT_EQ(merged.designs.size(), 6U);
  EXPECT_EQ(missing_designs(merged), (std::vector<std::int64_t>{1, 4, 7}));
}

TEST(Merge, TakesWhatAnUnfinishedDataSetHoldsSoFar) {
  const testing::TemporaryFolder folder;
  {
    Journal journal(journal_path(folder / "data.h5"), sample_recipe(), {0, 4, 0, 1});
    journal.append(sample_design(1));
  }
  EXPECT_EQ(read_finished_or_partial(folder / "data.h5").designs.size(), 1U);
  write_dataset(folder / "data.h5", sample_dataset({0, 4, 0, 1}));
  EXPECT_EQ(read_finished_or_partial(folder / "data.h5").designs.size(), 4U);
}

}  // namespace
}  // namespace supple::dataset
