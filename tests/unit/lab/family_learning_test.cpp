#include "supple/lab/family_learning.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "supple/base/random.h"
#include "supple/neural/model.h"
#include "supple/tiling/definition_text.h"
#include "supple/tiling/isohedral_types.h"
#include "support/expect_error.h"
#include "support/temporary_folder.h"

namespace supple::lab {
namespace {

namespace fs = std::filesystem;

/// A run of a few small designs and networks, for parallelograms whose beams widen with a parameter. It takes some
/// seconds, and the network is a poor one.
LearningOptions quick() {
  LearningOptions options;
  constexpr int parallelograms = 41;
  auto definition = tiling::definition_of(*tiling::find_isohedral_type(parallelograms), 0.3, 0.25);
  definition.id = "own";
  definition.parameters[0].range = {0.9, 1.3, 1};
  definition.parameters[1].range = {0.3, 0.6, 0.4};
  definition.parameters.push_back({"Width of the beams", {0.2, 0.3, 0.25}});
  definition.beam_width = {0, 0, 0, 1};
  auto& data = options.data;
  data.family = definition.id;
  data.own_family = std::make_shared<const tiling::Family>(tiling::make_family(definition));
  data.simulation.mesh.mesh_size = 1;
  data.loads = {.tension_paths = 1,
                .compression_paths = 1,
                .biaxial_paths = 1,
                .tension_states = 6,
                .compression_states = 6,
                .biaxial_states = 2,
                .max_stretch = 1.05,
                .min_stretch = 0.95,
                .max_biaxial_stretch = 1.02,
                .min_biaxial_stretch = 0.99};
  options.plan = {.even_designs = 24,
                  .rounds = 2,
                  .round_designs = 4,
                  .members = 2,
                  .member_width = 16,
                  .member_epochs = 40,
                  .width = 32,
                  .epochs = 250};
  return options;
}

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Keeps what is reported, and asks for a stop after a number of reports.
class Reports : public LearningListener {
 public:
  explicit Reports(int stop_after = -1) : stop_after_(stop_after) {}

  void progress(double fraction, const std::string& stage) override {
    EXPECT_GE(fraction, last) << stage;
    EXPECT_LE(fraction, 1 + 1e-9) << stage;
    last = fraction;
    stages.insert(stage);
    if (stop_after_-- == 0) token.request(StopReason::cancelled);
  }
  void error_reached(double error, std::int64_t designs) override { errors.emplace_back(error, designs); }

  CancellationToken token;
  double last = 0;
  std::set<std::string> stages;
  std::vector<std::pair<double, std::int64_t>> errors;

 private:
  int stop_after_;
};

class FamilyLearning : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder;
};

TEST_F(FamilyLearning, MakesAModelOfTheFamilyWithItsCard) {
  Reports reports;
  const auto options = quick();
  const auto result = learn_family(options, folder.path(), reports.token, &reports);
  ASSERT_TRUE(result.finished);
  EXPECT_EQ(result.designs, 24 + 2 * 4);
  EXPECT_EQ(reports.last, 1);
  EXPECT_EQ(reports.stages, (std::set<std::string>{"designs", "committee", "network", "error bars"}));
  ASSERT_EQ(reports.errors.size(), 3U);
  EXPECT_EQ(reports.errors[0].second, 24);
  EXPECT_EQ(reports.errors[2], (std::pair{result.error, std::int64_t{32}}));
  const auto model = neural::read_model(result.model);
  EXPECT_EQ(model.family, "own");
  EXPECT_EQ(tiling::definition_of_text(model.definition), *options.data.own_family->definition);
  EXPECT_NE(content(folder / "model.md").find("own"), std::string::npos);
  EXPECT_LT(result.error, 0.5);
  // The same call finds that all is done.
  Reports again;
  EXPECT_EQ(learn_family(options, folder.path(), again.token, &again).error, result.error);

  auto other = options;
  other.plan.epochs += 1;
  testing::expect_error("dataset.different_recipe", [&] { (void)learn_family(other, folder.path()); });
}

TEST_F(FamilyLearning, EndsWithTheSameModelAfterAnyNumberOfStops) {
  const auto options = quick();
  const auto whole = learn_family(options, folder / "whole");
  RandomStream random("family_learning.stops", 1);
  int stops = 0;
  LearningResult stopped;
  while (!stopped.finished && stops < 200) {
    Reports reports(static_cast<int>(random.uniform(0, 60)));
    stopped = learn_family(options, folder / "stopped", reports.token, &reports);
    stops += stopped.finished ? 0 : 1;
  }
  EXPECT_GT(stops, 8);
  ASSERT_TRUE(stopped.finished);
  EXPECT_EQ(content(stopped.model), content(whole.model)) << "in every byte";
}

TEST_F(FamilyLearning, ChoosesNoMoreDesignsOnceTheErrorIsReached) {
  auto options = quick();
  options.error = 0.9;
  Reports reports;
  const auto result = learn_family(options, folder.path(), reports.token, &reports);
  EXPECT_TRUE(result.finished);
  EXPECT_EQ(result.designs, 24);
  EXPECT_EQ(reports.last, 1);
}

TEST_F(FamilyLearning, WaitsForTheFolderThatAnotherRunIsLeaving) {
  auto options = quick();
  options.data.simulation.mesh.max_nodes = 10;
  const auto path = folder / "lock";
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  ASSERT_GE(descriptor, 0);
  ASSERT_EQ(::flock(descriptor, LOCK_EX | LOCK_NB), 0);
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    ::close(descriptor);
  });
  testing::expect_error("training.too_few_designs", [&] { (void)learn_family(options, folder.path()); });
  other.join();
  // A run that is asked to stop does not wait.
  const int again = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(again, LOCK_EX | LOCK_NB), 0);
  CancellationToken token;
  token.request(StopReason::cancelled);
  EXPECT_FALSE(learn_family(options, folder.path(), token).finished);
  ::close(again);
}

TEST_F(FamilyLearning, SaysWhyNoDesignCanBeSimulated) {
  auto options = quick();
  options.data.simulation.mesh.max_nodes = 10;
  const auto error =
      testing::expect_error("training.too_few_designs", [&] { (void)learn_family(options, folder.path()); });
  EXPECT_NE(std::string(error.what()).find("nodes"), std::string::npos) << error.what();
}

}  // namespace
}  // namespace supple::lab
