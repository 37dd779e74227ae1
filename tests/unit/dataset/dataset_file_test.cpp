#include "supple/dataset/dataset_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "sample_data.h"
#include "supple/base/error.h"
#include "support/temporary_folder.h"

namespace supple::dataset {
namespace {

std::string code_of(const std::filesystem::path& path) {
  try {
    read_dataset(path);
  } catch (const Error& error) {
    return error.code();
  }
  return {};
}

class DatasetFile : public ::testing::TestWithParam<bool> {};

TEST_P(DatasetFile, ReadsBackEveryValueItWrote) {
  const testing::TemporaryFolder folder;
  const Dataset written = sample_dataset({3, 9, 1, 2});
  write_dataset(folder / "data.h5", written, {false, GetParam()});
  const Dataset read = read_dataset(folder / "data.h5");
  EXPECT_EQ(read.recipe, written.recipe);
  EXPECT_EQ(read.selection, written.selection);
  EXPECT_EQ(all_values(read.designs), all_values(written.designs));
}

INSTANTIATE_TEST_SUITE_P(PlainAndCompressed, DatasetFile, ::testing::Bool());

TEST(DatasetFilePrecision, KeepsDesignsExactAndRoundsRowsToSingle) {
  const testing::TemporaryFolder folder;
  const Dataset written = sample_dataset({0, 4, 0, 1});
  write_dataset(folder / "data.h5", written, {true, true});
  const Dataset read = read_dataset(folder / "data.h5");
  for (std::size_t d = 0; d < written.designs.size(); ++d) {
    EXPECT_EQ(read.designs[d].parameters, written.designs[d].parameters);
    for (std::size_t r = 0; r < written.designs[d].rows.size(); ++r) {
      const double exact = written.designs[d].rows[r].stress[1];
      EXPECT_EQ(read.designs[d].rows[r].stress[1], static_cast<double>(static_cast<float>(exact)));
      EXPECT_NE(read.designs[d].rows[r].stress[1], exact);
    }
  }
}

TEST(DatasetFileBytes, AreTheSameForTheSameData) {
  const testing::TemporaryFolder folder;
  write_dataset(folder / "a.h5", sample_dataset({0, 6, 0, 1}), {true, true});
  write_dataset(folder / "b.h5", sample_dataset({0, 6, 0, 1}), {true, true});
  EXPECT_EQ(testing::bytes_of(folder / "a.h5"), testing::bytes_of(folder / "b.h5"));
}

TEST(DatasetFileEmpty, CanHoldNoDesignOrOnlyRejectedOnes) {
  const testing::TemporaryFolder folder;
  for (const Selection selection : {Selection{0, 1, 1, 2}, Selection{3, 1, 0, 1}}) {
    const Dataset written = sample_dataset(selection);
    write_dataset(folder / "data.h5", written, {true, true});
    EXPECT_EQ(all_values(read_dataset(folder / "data.h5").designs), all_values(written.designs));
  }
}

TEST(DatasetFileWriting, LeavesNoFileBehindWhereItFails) {
  const testing::TemporaryFolder folder;
  Dataset data = sample_dataset({0, 2, 0, 1});
  data.designs[1].parameters.push_back(1);
  EXPECT_THROW(write_dataset(folder / "data.h5", data), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
  EXPECT_THROW(write_dataset(folder / "missing/data.h5", sample_dataset({0, 2, 0, 1})), Error);
}

TEST(DatasetFileReading, RefusesWhatIsNoDataSet) {
  const testing::TemporaryFolder folder;
  EXPECT_EQ(code_of(folder / "missing.h5"), "file.unreadable");
  std::ofstream(folder / "text.h5") << "no HDF5";
  EXPECT_EQ(code_of(folder / "text.h5"), "file.unreadable");
}

TEST(DatasetFileReading, RefusesATruncatedFile) {
  const testing::TemporaryFolder folder;
  write_dataset(folder / "data.h5", sample_dataset({0, 8, 0, 1}));
  const std::string whole = testing::bytes_of(folder / "data.h5");
  for (const double share : {0.1, 0.5, 0.9, 0.99}) {
    std::ofstream(folder / "cut.h5", std::ios::binary)
        << whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size())));
    EXPECT_EQ(code_of(folder / "cut.h5"), "file.unreadable") << share;
  }
}

}  // namespace
}  // namespace supple::dataset
