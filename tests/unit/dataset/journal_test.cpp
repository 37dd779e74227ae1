#include "supple/dataset/journal.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "sample_data.h"
#include "supple/base/error.h"
#include "support/temporary_folder.h"

namespace supple::dataset {
namespace {

constexpr Selection selection{0, 6, 0, 1};

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

/// Writes a journal of the designs 0 .. count - 1. Returns its sizes in bytes: without designs, and after each of them.
std::vector<std::size_t> write_journal(const std::filesystem::path& path, int count) {
  Journal journal(path, sample_recipe(), selection);
  std::vector<std::size_t> sizes{std::filesystem::file_size(path)};
  for (int i = 0; i < count; ++i) {
    journal.append(sample_design(i));
    sizes.push_back(std::filesystem::file_size(path));
  }
  return sizes;
}

std::string code_of_opening(const std::filesystem::path& path, const Recipe& recipe, const Selection& wanted) {
  try {
    const Journal journal(path, recipe, wanted);
  } catch (const Error& error) {
    return error.code();
  }
  return {};
}

TEST(Journal, GivesBackEveryDesignAfterItIsOpenedAgain) {
  const testing::TemporaryFolder folder;
  write_journal(folder / "j", 5);
  const Journal journal(folder / "j", sample_recipe(), selection);
  EXPECT_EQ(journal.content().discarded_bytes, 0);
  EXPECT_EQ(all_values(journal.content().data.designs), all_values(sample_dataset({0, 5, 0, 1}).designs));
}

TEST(Journal, SortsDesignsThatWereAppendedInAnyOrder) {
  const testing::TemporaryFolder folder;
  {
    Journal journal(folder / "j", sample_recipe(), selection);
    for (const int i : {4, 1, 3}) journal.append(sample_design(i));
  }
  const auto designs = Journal::read(folder / "j").data.designs;
  ASSERT_EQ(designs.size(), 3U);
  EXPECT_EQ(designs[0].index, 1);
  EXPECT_EQ(designs[1].index, 3);
  EXPECT_EQ(designs[2].index, 4);
}

TEST(Journal, KeepsTheCompleteDesignsWhereverItsFileIsCutOff) {
  const testing::TemporaryFolder folder;
  const auto sizes = write_journal(folder / "j", 3);
  const std::string whole = testing::bytes_of(folder / "j");
  for (std::size_t cut = 0; cut <= whole.size(); cut += cut < sizes[0] ? 1 : 173) {
    write_bytes(folder / "cut", whole.substr(0, cut));
    std::size_t complete = 0;
    while (complete + 1 < sizes.size() && sizes[complete + 1] <= cut) ++complete;
    {
      Journal journal(folder / "cut", sample_recipe(), selection);
      ASSERT_EQ(journal.content().data.designs.size(), complete) << "cut at byte " << cut;
      for (int i = static_cast<int>(complete); i < 3; ++i) journal.append(sample_design(i));
    }
    ASSERT_EQ(testing::bytes_of(folder / "cut"), whole) << "cut at byte " << cut;
  }
}

TEST(Journal, DropsALastDesignWithAFlippedBit) {
  const testing::TemporaryFolder folder;
  const auto sizes = write_journal(folder / "j", 2);
  std::string bytes = testing::bytes_of(folder / "j");
  bytes[(sizes[1] + sizes[2]) / 2] ^= 4;
  write_bytes(folder / "j", bytes);
  const auto content = Journal::read(folder / "j");
  EXPECT_EQ(content.data.designs.size(), 1U);
  EXPECT_EQ(content.discarded_bytes, static_cast<std::int64_t>(sizes[2] - sizes[1]));
}

TEST(Journal, RefusesToGoOnWithOtherSettings) {
  const testing::TemporaryFolder folder;
  write_journal(folder / "j", 1);
  Recipe other = sample_recipe();
  other.set("tolerance", 1e-8, "1");
  EXPECT_EQ(code_of_opening(folder / "j", other, selection), "dataset.different_recipe");
  EXPECT_EQ(code_of_opening(folder / "j", sample_recipe(), {0, 7, 0, 1}), "dataset.different_recipe");
  EXPECT_EQ(code_of_opening(folder / "j", sample_recipe(), selection), "");
}

TEST(Journal, BelongsToOneProcessAtATime) {
  const testing::TemporaryFolder folder;
  const Journal first(folder / "j", sample_recipe(), selection);
  EXPECT_EQ(code_of_opening(folder / "j", sample_recipe(), selection), "dataset.in_use");
}

TEST(Journal, LeavesAForeignFileAsItIs) {
  const testing::TemporaryFolder folder;
  write_bytes(folder / "j", "notes of mine");
  EXPECT_EQ(code_of_opening(folder / "j", sample_recipe(), selection), "file.unreadable");
  EXPECT_EQ(testing::bytes_of(folder / "j"), "notes of mine");
}

TEST(Journal, IsGoneOnceItIsRemoved) {
  const testing::TemporaryFolder folder;
  Journal journal(folder / "j", sample_recipe(), selection);
  journal.remove();
  EXPECT_FALSE(std::filesystem::exists(folder / "j"));
}

}  // namespace
}  // namespace supple::dataset
