#include "supple/lab/dataset_maker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "sample_data.h"
#include "supple/base/error.h"
#include "supple/base/threads.h"
#include "supple/dataset/dataset_file.h"
#include "supple/dataset/journal.h"
#include "supple/dataset/merge.h"
#include "supple/lab/engine_version.h"
#include "support/temporary_folder.h"

namespace supple::lab {
namespace {

using dataset::Dataset;
using testing::TemporaryFolder;

/// Options with small loads on the coarsest mesh. A design takes about a tenth of a second.
DatasetOptions quick(std::int64_t designs) {
  DatasetOptions options;
  options.family = "IH01";
  options.designs = designs;
  options.corners = false;
  options.simulation.mesh.mesh_size = 1;
  options.loads.tension_paths = options.loads.compression_paths = options.loads.biaxial_paths = 1;
  options.loads.tension_states = options.loads.compression_states = options.loads.biaxial_states = 2;
  options.loads.max_stretch = 1.02;
  options.loads.min_stretch = 0.98;
  options.loads.max_biaxial_stretch = 1.02;
  options.loads.min_biaxial_stretch = 0.98;
  return options;
}

/// Compares everything except times, which differ from run to run.
void expect_same(const Dataset& a, const Dataset& b) {
  const auto timeless = [](dataset::Design design) {
    design.seconds = 0;
    design.costs.clear();
    for (auto& row : design.rows) row.seconds = 0;
    return design;
  };
  ASSERT_EQ(a.designs.size(), b.designs.size());
  for (std::size_t d = 0; d < a.designs.size(); ++d)
    EXPECT_TRUE(dataset::values(timeless(a.designs[d])) == dataset::values(timeless(b.designs[d]))) << "design " << d;
}

class StopAfter : public MakeListener {
 public:
  StopAfter(CancellationToken token, int designs) : token_(std::move(token)), left_(designs) {}
  void started(std::int64_t, std::int64_t, std::int64_t) override {}
  void state_reached() override {}
  void design_done(const dataset::Design&) override {
    if (--left_ == 0) token_.request(StopReason::cancelled);
  }

 private:
  CancellationToken token_;
  int left_;
};

class DatasetMaker : public ::testing::Test {
 protected:
  void SetUp() override { set_thread_count(2); }
  void TearDown() override { set_thread_count(0); }
  TemporaryFolder folder;
};

TEST_F(DatasetMaker, WritesEveryPlannedStateOfEveryDesign) {
  const auto result = make_dataset(quick(4), folder / "data.h5");
  EXPECT_TRUE(result.finished);
  EXPECT_EQ(result.computed, 4);
  const Dataset data = dataset::read_dataset(folder / "data.h5");
  ASSERT_EQ(data.designs.size(), 4U);
  int simulated = 0;
  for (const auto& design : data.designs) {
    if (design.rejected()) continue;
    ++simulated;
    EXPECT_EQ(design.rows.size(), 6U);
    for (const auto& row : design.rows) {
      EXPECT_GT(row.energy_density, 0);
      EXPECT_LE(row.residual, 1e-6);
      EXPECT_GT(row.tangent[0], 0);
    }
    EXPECT_EQ(design.engine, engine_version());
    EXPECT_FALSE(design.costs.empty());
  }
  EXPECT_GE(simulated, 3);
  EXPECT_FALSE(std::filesystem::exists(dataset::journal_path(folder / "data.h5")));
}

TEST_F(DatasetMaker, DoesNotDependOnThreadsOrShards) {
  make_dataset(quick(5), folder / "two.h5");
  set_thread_count(1);
  make_dataset(quick(5), folder / "one.h5");
  std::vector<Dataset> shards;
  for (const int k : {0, 1}) {
    auto options = quick(5);
    options.shards = 2;
    options.shard = k;
    make_dataset(options, folder / std::to_string(k));
    shards.push_back(dataset::read_dataset(folder / std::to_string(k)));
  }
  const Dataset whole = dataset::read_dataset(folder / "two.h5");
  expect_same(dataset::read_dataset(folder / "one.h5"), whole);
  expect_same(dataset::merge(shards), whole);
}

TEST_F(DatasetMaker, GoesOnWhereItWasStopped) {
  const CancellationToken token;
  StopAfter listener(token, 2);
  const auto first = make_dataset(quick(6), folder / "data.h5", token, &listener);
  EXPECT_FALSE(first.finished);
  EXPECT_GE(first.computed, 2);
  EXPECT_LT(first.computed, 6);
  EXPECT_FALSE(std::filesystem::exists(folder / "data.h5"));
  const auto second = make_dataset(quick(6), folder / "data.h5");
  EXPECT_TRUE(second.finished);
  EXPECT_EQ(second.computed, 6 - first.computed);
  make_dataset(quick(6), folder / "at_once.h5");
  expect_same(dataset::read_dataset(folder / "data.h5"), dataset::read_dataset(folder / "at_once.h5"));
}

TEST_F(DatasetMaker, LeavesAFinishedFileAsItIs) {
  make_dataset(quick(1), folder / "data.h5");
  const auto written = std::filesystem::last_write_time(folder / "data.h5");
  // A journal remains if a run is killed after it wrote the file and before it removed its journal.
  { const dataset::Journal journal(dataset::journal_path(folder / "data.h5"), recipe_of(quick(1)), {0, 1, 0, 1}); }
  const auto again = make_dataset(quick(1), folder / "data.h5");
  EXPECT_TRUE(again.finished);
  EXPECT_EQ(again.computed, 0);
  EXPECT_EQ(std::filesystem::last_write_time(folder / "data.h5"), written);
  EXPECT_FALSE(std::filesystem::exists(dataset::journal_path(folder / "data.h5")));
}

TEST_F(DatasetMaker, DoesNotMixSettings) {
  make_dataset(quick(1), folder / "data.h5");
  auto other = quick(1);
  other.simulation.tolerance = 1e-6;
  try {
    make_dataset(other, folder / "data.h5");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "dataset.different_recipe");
    EXPECT_NE(std::string(error.what()).find("tolerance"), std::string::npos) << error.what();
  }
}

TEST_F(DatasetMaker, RecordsADesignThatTheEngineRefuses) {
  auto options = quick(1);
  options.parameters = {0.9, 0.5, 0.1, 0.6};
  make_dataset(options, folder / "data.h5");
  const auto data = dataset::read_dataset(folder / "data.h5");
  ASSERT_EQ(data.designs.size(), 1U);
  EXPECT_EQ(data.designs[0].error_code, "tiling.parameter_out_of_bounds");
  EXPECT_FALSE(data.designs[0].error_message.empty());
  EXPECT_TRUE(data.designs[0].rows.empty());
}

/// Data sets of an older engine, of which the present one computes some designs differently.
class RenewedDataset : public DatasetMaker {
 protected:
  void SetUp() override {
    DatasetMaker::SetUp();
    make_dataset(quick(5), folder / "first.h5");
    first = dataset::read_dataset(folder / "first.h5");
    old = first;
    for (dataset::Design& design : old.designs) design.engine = "older";
  }
  std::vector<std::int64_t> renewed(const Dataset& data) const {
    std::vector<std::int64_t> indices;
    for (const dataset::Design& design : data.designs)
      if (design.engine != "older") indices.push_back(design.index);
    return indices;
  }
  Dataset first, old;
};

TEST_F(RenewedDataset, KeepsWhatTheEngineStillComputes) {
  const RenewResult result = renew_dataset(old, {}, folder / "new.h5");
  EXPECT_TRUE(result.finished);
  EXPECT_EQ(result.renewed, 0);
  const Dataset renewed_data = dataset::read_dataset(folder / "new.h5");
  EXPECT_EQ(renewed(renewed_data), std::vector<std::int64_t>{});
  expect_same(renewed_data, old);
}

TEST_F(RenewedDataset, SimulatesAnewWhereStressNextToRestHasChanged) {
  for (dataset::Row& row : old.designs[1].rows) row.stress[0] *= 1.01;
  // For one kind of load alone: the first state of the last path has changed.
  for (dataset::Row& row : old.designs[3].rows) {
    if (row.path == 2 && row.position == 0) row.stress[1] += 0.01 * std::abs(row.stress[1]) + 1e-6;
  }
  // This change is less than the tolerance.
  for (dataset::Row& row : old.designs[4].rows) row.stress[0] *= 1.0001;
  const RenewResult result = renew_dataset(old, {}, folder / "new.h5");
  EXPECT_EQ(result.designs, 5);
  EXPECT_EQ(result.renewed, 2);
  const Dataset data = dataset::read_dataset(folder / "new.h5");
  EXPECT_EQ(renewed(data), (std::vector<std::int64_t>{1, 3}));
  expect_same({first.recipe, first.selection, {first.designs[1], first.designs[3]}},
              {data.recipe, data.selection, {data.designs[1], data.designs[3]}});
}

TEST_F(RenewedDataset, SimulatesAnewWhatHadFailedAndOnDemandWhatWasInContact) {
  old.designs[0].error_code = "tiling.self_intersecting";
  old.designs[0].rows.clear();
  old.designs[2].paths[1].reached = 1;
  old.designs[4].rows[3].contacts = 2;
  EXPECT_EQ(renew_dataset(old, {}, folder / "new.h5").renewed, 2);
  EXPECT_EQ(renewed(dataset::read_dataset(folder / "new.h5")), (std::vector<std::int64_t>{0, 2}));
  EXPECT_EQ(renew_dataset(old, {.contacts = true}, folder / "contacts.h5").renewed, 3);
  EXPECT_EQ(renewed(dataset::read_dataset(folder / "contacts.h5")), (std::vector<std::int64_t>{0, 2, 4}));
}

TEST_F(RenewedDataset, HoldsTheDesignsOfTheOldOneAloneAndGoesOnWhereItWasStopped) {
  old.designs.erase(old.designs.begin() + 2);
  CancellationToken token;
  StopAfter stop(token, 1);
  set_thread_count(1);
  EXPECT_FALSE(renew_dataset(old, {}, folder / "new.h5", token, &stop).finished);
  EXPECT_FALSE(std::filesystem::exists(folder / "new.h5"));
  const RenewResult result = renew_dataset(old, {}, folder / "new.h5");
  EXPECT_TRUE(result.finished);
  EXPECT_EQ(result.designs, 4);
  expect_same(dataset::read_dataset(folder / "new.h5"), old);
}

TEST_F(RenewedDataset, IsRefusedWithATolerancesLimitsAndForAnotherFamily) {
  const auto code_of = [&](const Dataset& data, const RenewOptions& options) {
    try {
      renew_dataset(data, options, folder / "new.h5");
    } catch (const Error& error) {
      return error.code();
    }
    return std::string("none");
  };
  EXPECT_EQ(code_of(old, {.tolerance = 0}), "dataset.invalid_option");
  EXPECT_EQ(code_of(old, {.tolerance = 1}), "dataset.invalid_option");
  old.recipe.set("beam_width", 0.2, "tiling units");
  EXPECT_EQ(code_of(old, {}), "dataset.different_recipe");
}

}  // namespace
}  // namespace supple::lab
