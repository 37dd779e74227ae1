// Data sets that are cut off, damaged or extreme. Designs that were appended must be read back, and damaged files must
// be refused.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <thread>

#include "sample_data.h"
#include "supple/base/error.h"
#include "supple/dataset/dataset_file.h"
#include "supple/dataset/journal.h"
#include "supple/dataset/merge.h"
#include "support/temporary_folder.h"

namespace supple::dataset {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Runs `work` in a child process and returns its id. The child ends without the clean-up of this process.
template <class Work>
pid_t in_another_process(Work work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    _exit(0);
  }
  return child;
}

int exit_status(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

/// Hard: the process is killed at any instruction, also within a write. Every design whose append has returned must be
/// read back.
TEST(HardDatasets, AProcessThatIsKilledAgainAndAgainLosesNoDesign) {
  const testing::TemporaryFolder folder;
  constexpr Selection selection{0, 400, 0, 1};
  RandomStream random("moments of death", 1);
  std::size_t kept = 0;
  for (int life = 0; life < 200 && kept < 400; ++life) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = in_another_process([&] {
      Journal journal(folder / "j", sample_recipe(), selection);
      for (const std::int64_t index : missing_designs(journal.content().data)) {
        journal.append(sample_design(index));
        if (write(ends[1], "x", 1) != 1) _exit(1);
      }
    });
    close(ends[1]);
    std::this_thread::sleep_for(std::chrono::microseconds(random.below(20'000)));
    kill(child, SIGKILL);
    exit_status(child);
    std::size_t appended = 0;
    for (char x = 0; read(ends[0], &x, 1) == 1;) ++appended;
    close(ends[0]);
    if (!std::filesystem::exists(folder / "j")) continue;  // the process was killed before it made the file
    const auto content = Journal::read(folder / "j");
    ASSERT_GE(content.data.designs.size(), kept + appended) << "in life " << life;
    ASSERT_LE(content.data.designs.size(), kept + appended + 1) << "one may have been written and not been told of";
    kept = content.data.designs.size();
  }
  {
    Journal journal(folder / "j", sample_recipe(), selection);
    for (const std::int64_t index : missing_designs(journal.content().data)) journal.append(sample_design(index));
  }
  EXPECT_EQ(all_values(Journal::read(folder / "j").data.designs), all_values(sample_dataset(selection).designs));
}

/// Hard: the disk is full in the middle of a record. The error must be reported, and earlier records must remain.
TEST(HardDatasets, AFullDiskIsToldAndTheJournalGoesOnAfterwards) {
  const testing::TemporaryFolder folder;
  constexpr Selection selection{0, 8, 0, 1};
  const pid_t child = in_another_process([&] {
    signal(SIGXFSZ, SIG_IGN);
    Journal journal(folder / "j", sample_recipe(), selection);
    for (int i = 0; i < 3; ++i) journal.append(sample_design(i));
    const auto room = static_cast<rlim_t>(std::filesystem::file_size(folder / "j")) + 20;
    const rlimit limit{room, room};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      journal.append(sample_design(3 + 1));
    } catch (const Error& error) {
      _exit(error.code() == "file.write_failed" ? 42 : 1);
    }
  });
  const int status = exit_status(child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 42) << "the failure is told by its code";
  {
    Journal journal(folder / "j", sample_recipe(), selection);
    EXPECT_EQ(journal.content().data.designs.size(), 3U);
    for (const std::int64_t index : missing_designs(journal.content().data)) journal.append(sample_design(index));
  }
  EXPECT_EQ(all_values(Journal::read(folder / "j").data.designs), all_values(sample_dataset(selection).designs));
}

/// Hard: any bit of the file may be wrong, also in addresses that the HDF5 library follows without checking them.
TEST(HardDatasets, AFileWithAFlippedBitIsRefused) {
  const testing::TemporaryFolder folder;
  for (const bool compressed : {false, true}) {
    const Dataset data = sample_dataset({0, 6, 0, 1});
    write_dataset(folder / "d.h5", data, {false, compressed});
    const std::string whole = bytes_of(folder / "d.h5");
    RandomStream random("flipped bits", compressed ? 2 : 1);
    for (int trial = 0; trial < 300; ++trial) {
      std::string damaged = whole;
      const auto at = static_cast<std::size_t>(random.below(static_cast<int>(whole.size())));
      damaged[at] ^= static_cast<char>(1 << random.below(8));
      std::ofstream(folder / "b.h5", std::ios::binary | std::ios::trunc) << damaged;
      try {
        // Only damage of the label of the checksum does no harm.
        EXPECT_EQ(all_values(read_dataset(folder / "b.h5").designs), all_values(data.designs)) << "byte " << at;
        EXPECT_GE(at, whole.size() - 24) << "damage that is not noticed";
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), "file.unreadable") << error.what();
      }
    }
  }
}

/// Hard: the file is from before data sets had checksums.
TEST(HardDatasets, AFileWithoutAChecksumIsRead) {
  const testing::TemporaryFolder folder;
  const Dataset data = sample_dataset({0, 6, 0, 1});
  write_dataset(folder / "d.h5", data);
  std::filesystem::resize_file(folder / "d.h5", std::filesystem::file_size(folder / "d.h5") - 24);
  EXPECT_EQ(all_values(read_dataset(folder / "d.h5").designs), all_values(data.designs));
}

/// Hard: each shard has one design, and shards are merged in any order.
TEST(HardDatasets, ManyShardsOfOneDesignEachAreTheWholeDataSet) {
  constexpr std::int64_t shards = 500;
  std::vector<Dataset> parts;
  parts.reserve(shards);
  for (std::int64_t shard = 0; shard < shards; ++shard)
    parts.push_back(sample_dataset({0, shards, (7 * shard + 3) % shards, shards}));
  const Dataset merged = merge(std::move(parts));
  EXPECT_EQ(merged.selection, (Selection{0, shards, 0, 1}));
  EXPECT_EQ(all_values(merged.designs), all_values(sample_dataset({0, shards, 0, 1}).designs));
}

/// Hard: numbers are infinite or at the limits of their range, texts contain line breaks, and designs are empty.
TEST(HardDatasets, ExtremeValuesComeBackAsTheyWere) {
  const testing::TemporaryFolder folder;
  Dataset data{sample_recipe(), {5, 3, 0, 1}, {}};
  Design design = sample_design(4);
  design.index = 5;
  design.rows.front().tangent = {infinity, -infinity, std::numeric_limits<double>::denorm_min(), -0.0, 1e308, -1e-308};
  design.rows.front().energy_density = std::numeric_limits<double>::max();
  design.paths.front().message = std::string(100'000, '\n') + "\xF0\x9F\xA7\xB6";
  data.designs.push_back(design);
  Design nothing;
  nothing.index = 6;
  nothing.parameters = {infinity, -0.0};
  data.designs.push_back(nothing);
  Design stopped = sample_design(8);
  stopped.index = 7;
  stopped.rows.clear();
  for (Path& path : stopped.paths) path.reached = 0;
  data.designs.push_back(stopped);
  for (const bool compressed : {false, true}) {
    write_dataset(folder / "d.h5", data, {false, compressed});
    EXPECT_EQ(all_values(read_dataset(folder / "d.h5").designs), all_values(data.designs));
  }
  Journal(folder / "j", data.recipe, data.selection).append(design);
  EXPECT_EQ(all_values(Journal::read(folder / "j").data.designs), all_values(std::vector<Design>{design}));
}

}  // namespace
}  // namespace supple::dataset
