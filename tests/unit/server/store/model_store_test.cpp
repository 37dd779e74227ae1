#include "supple/store/model_store.h"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <future>
#include <iterator>

#include "supple/base/cancellation.h"
#include "supple/base/error.h"
#include "supple/store/store.h"
#include "supple/store/store_error.h"
#include "support/expect_error.h"
#include "support/temporary_folder.h"
#include "support/test_model.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto period = 5ms;

/// Model files are made before any store is: HDF5 is not thread safe. Tests copy them into their folders.
class ModelStoreTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new testing::TemporaryFolder;
    neural::write_model(*made_ / "a1", test::test_model("a", 1));
    neural::write_model(*made_ / "a2", test::test_model("a", 2));
    neural::write_model(*made_ / "b1", test::test_model("b", 1));
    auto faulty = test::test_model("faulty", 1);
    faulty.provenance.training_seconds = std::nan("");
    auto strange = test::test_model("strange", 1);
    strange.family = "own";
    neural::write_model(*made_ / "of_no_family", strange);
    strange.definition = "family definition 1\n";
    neural::write_model(*made_ / "of_damaged_family", strange);
    neural::write_model(*made_ / "faulty", faulty);
    std::ofstream(*made_ / "damaged") << testing::bytes_of(*made_ / "a2").substr(0, 3000);
  }
  static void TearDownTestSuite() { delete made_; }

  ~ModelStoreTest() override { store_.reset(); }

  static fs::path made(const char* name) { return *made_ / name; }

  /// Puts a file into the folder under another name, in one step.
  void put(const char* name, const std::string& as) {
    fs::copy_file(made(name), folder_ / (as + ".part"));
    fs::rename(folder_ / (as + ".part"), folder_ / as);
  }

  ModelStore::Options options() {
    ModelStore::Options options;
    options.folder = folder_;
    options.period = period;
    options.describe = [](const neural::Model& model, const std::string&) {
      if (std::isnan(model.provenance.training_seconds)) throw Error("computation.non_finite", "no number");
      return "{\"id\":\"" + model.id + "\"}";
    };
    options.log = [this](ModelStore::Level level, const std::string& text) {
      const std::lock_guard lock(mutex_);
      (level == ModelStore::Level::warning ? warnings_ : infos_).push_back(text);
    };
    return options;
  }

  ModelStore& start() {
    store_ = std::make_unique<ModelStore>(options());
    store_->wait_until_read();
    return *store_;
  }

  std::vector<std::string> warnings() const {
    const std::lock_guard lock(mutex_);
    return warnings_;
  }

  std::vector<std::string> ids() const {
    std::vector<std::string> result;
    for (const auto& model : store_->models()) result.push_back(model->model.id);
    return result;
  }

  /// Waits until a condition is true, which the next scans of the folder should bring about.
  template <class Condition>
  static bool soon(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(1ms);
    }
    return true;
  }
  static void some_looks() { std::this_thread::sleep_for(20 * period); }

  static inline const testing::TemporaryFolder* made_ = nullptr;
  const testing::TemporaryFolder temporary_folder_;
  const fs::path folder_ = temporary_folder_.path();
  std::unique_ptr<ModelStore> store_;

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> warnings_;
  std::vector<std::string> infos_;
};

using Ids = std::vector<std::string>;

TEST_F(ModelStoreTest, ShowsModelsOfAnOwnerToTheOwnerAlone) {
  const auto own = folder_ / "own";
  auto with_owners = options();
  with_owners.own_folder = own;
  put("a1", "a.h5");
  store_ = std::make_unique<ModelStore>(with_owners);
  store_->wait_until_read();
  EXPECT_EQ(ids(), (Ids{"a"})) << "the folder of models with owners need not be there";
  fs::create_directories(own);
  put("b1", "own/" + ModelStore::mark_of("alice") + "-b.h5");
  EXPECT_TRUE(soon([&] { return store_->size() == 2; }));
  EXPECT_EQ(ids(), (Ids{"a"}));
  EXPECT_EQ(store_->models("alice").size(), 2U);
  EXPECT_EQ(store_->models("bob").size(), 1U);
  EXPECT_EQ(store_->get("b", "alice")->model.id, "b");
  EXPECT_EQ(VisibleModels(*store_, "alice").models().size(), 2U);
  for (const std::string owner : {"bob", ""}) {
    const auto error = testing::expect_error<ModelNotFound>("model.not_found", [&] { (void)store_->get("b", owner); });
    EXPECT_EQ(std::string(error.what()).find("known are a, b"), std::string::npos) << "it is not even named";
  }
  put("b1", "own/c.h5");
  EXPECT_TRUE(soon([&] { return store_->damaged() == 1; }));
  EXPECT_NE(warnings().back().find("mark of an owner"), std::string::npos);
}

TEST_F(ModelStoreTest, LeavesOutModelsWhoseFamilyIsUnknown) {
  put("a1", "a.h5");
  put("of_no_family", "b.h5");
  put("of_damaged_family", "c.h5");
  start();
  EXPECT_EQ(ids(), (Ids{"a"}));
  EXPECT_EQ(store_->damaged(), 2U);
  EXPECT_NE(warnings()[0].find("There is no family \"own\""), std::string::npos) << warnings()[0];
  EXPECT_NE(warnings()[1].find("cannot be read: line"), std::string::npos) << warnings()[1];
}

TEST_F(ModelStoreTest, ReadsTheModelFilesOfTheFolderAndNothingElse) {
  put("b1", "z.h5");
  put("a1", "y.h5");
  put("a2", "model.hdf5");
  fs::create_directories(folder_ / "folder.h5");
  fs::create_directories(folder_ / "datasets");
  put("a2", "datasets/set.h5");
  const auto& store = start();
  EXPECT_EQ(ids(), (Ids{"a", "b"}));
  EXPECT_EQ(store.size(), 2U);
  const auto model = store.get("a");
  EXPECT_EQ(model->sha256, sha256(testing::bytes_of(folder_ / "y.h5")));
  EXPECT_EQ(model->description, R"({"id":"a"})");
  EXPECT_EQ(model->model.provenance.seed, 1);
  EXPECT_EQ(model->evaluator.shape().parameters, 2);
  EXPECT_TRUE(warnings().empty());
}

TEST_F(ModelStoreTest, SaysNothingAboutAFileWhoseReadingIsStopped) {
  put("a1", "a.h5");
  std::atomic<bool> is_stopped{true};
  auto given = options();
  given.describe = [&is_stopped](const neural::Model& model, const std::string&) {
    if (is_stopped) throw Cancelled(StopReason::shutdown);
    return "{\"id\":\"" + model.id + "\"}";
  };
  store_ = std::make_unique<ModelStore>(given);
  store_->wait_until_read();
  EXPECT_TRUE(ids().empty());
  EXPECT_EQ(store_->damaged(), 0U);
  EXPECT_TRUE(warnings().empty());
  is_stopped = false;
  EXPECT_TRUE(soon([&] { return ids() == Ids{"a"}; }));
  store_.reset();  // before what it calls
}

TEST_F(ModelStoreTest, NamesTheModelsThatThereAreWhereOneIsNot) {
  const auto message_of = [this] {
    try {
      store_->get("c");
    } catch (const ModelNotFound& error) {
      EXPECT_EQ(error.code(), "model.not_found");
      return std::string(error.what());
    }
    ADD_FAILURE() << "nothing was thrown";
    return std::string();
  };
  start();
  EXPECT_NE(message_of().find("no model is loaded"), std::string::npos);
  put("a1", "a.h5");
  put("b1", "b.h5");
  ASSERT_TRUE(soon([&] { return store_->size() == 2; }));
  EXPECT_NE(message_of().find("known are a, b"), std::string::npos);
}

TEST_F(ModelStoreTest, PicksUpNewChangedAndRemovedFiles) {
  auto& store = start();
  EXPECT_EQ(store.size(), 0U);
  put("a1", "model.h5");
  ASSERT_TRUE(soon([&] { return ids() == Ids{"a"}; }));
  const auto first = store.get("a");
  put("a2", "model.h5");
  ASSERT_TRUE(soon([&] { return store.get("a")->sha256 != first->sha256; }));
  EXPECT_EQ(store.get("a")->model.provenance.seed, 2);
  put("b1", "model.h5");
  ASSERT_TRUE(soon([&] { return ids() == Ids{"b"}; })) << "a file may bring another id";
  fs::remove(folder_ / "model.h5");
  ASSERT_TRUE(soon([&] { return store.size() == 0; }));
  EXPECT_TRUE(warnings().empty());
  EXPECT_EQ(first->model.provenance.seed, 1) << "who holds a model keeps it";
  EXPECT_TRUE(
      first->evaluator
          .evaluate(first->evaluator.design(std::vector{0.15, 0.65}), Eigen::Vector3d(0.1, 0, 0), neural::Order::stress)
          .stress.allFinite());
}

TEST_F(ModelStoreTest, SeesAChangeThatLeavesNameSizeAndTimeAsTheyWere) {
  put("a1", "model.h5");
  auto& store = start();
  const auto time = fs::last_write_time(folder_ / "model.h5");
  ASSERT_EQ(fs::file_size(made("a1")), fs::file_size(made("a2")));
  fs::copy_file(made("a2"), folder_ / "new");
  fs::last_write_time(folder_ / "new", time);
  fs::rename(folder_ / "new", folder_ / "model.h5");
  EXPECT_TRUE(soon([&] { return store.get("a")->model.provenance.seed == 2; }));
}

TEST_F(ModelStoreTest, ReportsADamagedFileOnceAndServesTheOthers) {
  put("damaged", "a.h5");
  put("b1", "b.h5");
  auto& store = start();
  EXPECT_EQ(ids(), Ids{"b"});
  some_looks();
  ASSERT_EQ(warnings().size(), 1U) << "it is not read again until it changes";
  EXPECT_NE(warnings()[0].find("a.h5"), std::string::npos);
  put("a1", "a.h5");
  EXPECT_TRUE(soon([&] { return store.size() == 2; }));
}

TEST_F(ModelStoreTest, ServesTheEarlierVersionOfAFileThatIsDamaged) {
  put("a1", "a.h5");
  auto& store = start();
  const auto hash = store.get("a")->sha256;
  put("damaged", "a.h5");
  ASSERT_TRUE(soon([&] { return warnings().size() == 1; }));
  EXPECT_NE(warnings()[0].find("earlier version stays"), std::string::npos);
  some_looks();
  EXPECT_EQ(warnings().size(), 1U);
  EXPECT_EQ(store.get("a")->sha256, hash);
  put("a2", "a.h5");
  EXPECT_TRUE(soon([&] { return store.get("a")->sha256 != hash; }));
}

TEST_F(ModelStoreTest, LeavesOutWhatCannotBeDescribed) {
  put("faulty", "1.h5");
  std::ofstream(folder_ / "2.h5").flush();
  start();
  EXPECT_TRUE(ids().empty());
  EXPECT_EQ(warnings().size(), 2U);
}

TEST_F(ModelStoreTest, ServesTheFirstByNameOfTwoFilesWithOneId) {
  put("a2", "second.h5");
  put("a1", "first.h5");
  auto& store = start();
  EXPECT_EQ(store.get("a")->model.provenance.seed, 1);
  EXPECT_EQ(ids(), Ids{"a"});
  some_looks();
  ASSERT_EQ(warnings().size(), 1U);
  EXPECT_NE(warnings()[0].find("second.h5"), std::string::npos) << warnings()[0];
  put("b1", "third.h5");
  ASSERT_TRUE(soon([&] { return store.size() == 2; }));
  EXPECT_EQ(warnings().size(), 1U) << "known already";
  fs::remove(folder_ / "first.h5");
  EXPECT_TRUE(soon([&] { return store.get("a")->model.provenance.seed == 2; }));
}

TEST_F(ModelStoreTest, KeepsWhatItHasWhileTheFolderCannotBeRead) {
  put("a1", "a.h5");
  auto& store = start();
  const auto away = fs::path(folder_.string() + "_away");
  fs::rename(folder_, away);
  ASSERT_TRUE(soon([&] { return warnings().size() == 1; }));
  some_looks();
  EXPECT_EQ(warnings().size(), 1U);
  EXPECT_EQ(store.size(), 1U);
  fs::remove(away / "a.h5");
  fs::rename(away, folder_);
  EXPECT_TRUE(soon([&] { return store.size() == 0; }));
}

TEST_F(ModelStoreTest, IsReadOnceAllFilesOfTheFirstLookAre) {
  put("a1", "a.h5");
  put("b1", "b.h5");
  std::promise<void> gate;
  auto slow = options();
  slow.describe = [opened = gate.get_future().share()](const neural::Model& model, const std::string&) {
    if (model.id == "b") opened.wait();
    return std::string("{}");
  };
  store_ = std::make_unique<ModelStore>(slow);
  std::this_thread::sleep_for(50ms);
  EXPECT_FALSE(store_->has_been_read());
  gate.set_value();
  store_->wait_until_read();
  EXPECT_TRUE(store_->has_been_read());
  EXPECT_EQ(store_->size(), 2U);
}

TEST_F(ModelStoreTest, EndsAtOnceHoweverRarelyItLooks) {
  auto rare = options();
  rare.period = 1h;
  for (const bool with_folder : {true, false}) {
    if (!with_folder) rare.folder.clear();
    store_ = std::make_unique<ModelStore>(rare);
    store_->wait_until_read();
    const auto start = std::chrono::steady_clock::now();
    store_.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - start, 60s);
  }
}

}  // namespace
}  // namespace supple::store
