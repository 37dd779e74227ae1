#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/helper_processes.h"
#include "supple/files/hdf5_file.h"
#include "supple/files/seal.h"
#include "supple/neural/model.h"
#include "support/expect_error.h"
#include "support/random_network.h"
#include "support/temporary_folder.h"

namespace supple::neural {
namespace {

class ModelFile : public ::testing::Test {
 protected:
  void SetUp() override {
    NetworkShape shape;
    shape.width = 24;
    shape.parameters = 2;
    model.id = "ih67";
    model.family = "IH67";
    model.network = random_network(shape, 5);
    model.network.symmetries = {Eigen::Vector3d(1, 1, -1).asDiagonal()};
    model.strain_range = {-0.25, 0.63, 0.4};
    model.provenance.data_set = "IH67-0-of-12.h5 IH67-1-of-12.h5";
    model.provenance.designs = 410;
    model.provenance.seed = 3;
    model.provenance.options = {{"width", "24"}, {"optimizer", "soap"}};
    model.provenance.training_seconds = 12.5;
    model.design_split = SplitErrors{{0.01, 0.02, 0.005, 0.1}, {0.02, 0.04, 0.01, 0.2}, 50, 1900};
  }

  static std::string content(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static std::string code_of(const std::filesystem::path& file) {
    try {
      (void)read_model(file);
      return "none";
    } catch (const Error& error) {
      return error.code();
    }
  }

  testing::TemporaryFolder folder;
  std::filesystem::path path = folder / "model.h5";
  Model model;
};

TEST_F(ModelFile, HoldsEverythingThatWasWritten) {
  write_model(path, model);
  const auto back = read_model(path);
  EXPECT_EQ(back.id, model.id);
  EXPECT_EQ(back.family, model.family);
  EXPECT_EQ(back.network.shape.width, 24);
  ASSERT_EQ(back.network.symmetries.size(), 1U);
  EXPECT_EQ(back.network.symmetries[0], model.network.symmetries[0]);
  for (std::size_t i = 0; i < model.network.trunk.size(); ++i) {
    EXPECT_EQ(back.network.trunk[i].weights, model.network.trunk[i].weights);
    EXPECT_EQ(back.network.trunk[i].bias, model.network.trunk[i].bias);
  }
  EXPECT_EQ(back.network.stiffness[2].weights, model.network.stiffness[2].weights);
  EXPECT_EQ(back.network.upper, model.network.upper);
  EXPECT_EQ(back.strain_range.largest_relative_energy, 0.4);
  EXPECT_EQ(back.provenance.options, model.provenance.options);
  EXPECT_EQ(back.provenance.designs, 410);
  ASSERT_TRUE(back.design_split.has_value());
  EXPECT_EQ(back.design_split->gradient.percentile_99, 0.2);
  EXPECT_EQ(back.design_split->samples, 1900);
  EXPECT_FALSE(back.row_split.has_value());
}

TEST_F(ModelFile, TheFormOfRestAndFeaturesOfTheTileAreReadBack) {
  NetworkShape shape;
  shape.width = 24;
  shape.parameters = 2;
  shape.rest = RestForm::exact;
  shape.features = 17;
  shape.stiffness_layers = 3;
  model.network = random_network(shape, 6);
  write_model(path, model);
  const auto back = read_model(path);
  EXPECT_EQ(back.network.shape, shape);
  const auto& geometry = back.network.geometry;
  EXPECT_EQ(geometry.vertices, model.network.geometry.vertices);
  EXPECT_EQ(geometry.translations, model.network.geometry.translations);
  EXPECT_EQ(geometry.tiles, 2);
  EXPECT_EQ(geometry.beam_width, 0.12);
  const std::vector<double> parameters{0.2, 0.4};
  EXPECT_EQ(evaluate_features(geometry, parameters, true), evaluate_features(model.network.geometry, parameters, true));
  EXPECT_EQ(back.network.stiffness[3].weights, model.network.stiffness[3].weights);
}

TEST_F(ModelFile, TheDefinitionOfItsFamilyAndTheWidthOfItsBeamsAreReadBack) {
  EXPECT_EQ(model.definition, "");
  NetworkShape shape;
  shape.width = 24;
  shape.parameters = 2;
  shape.features = 17;
  model.network = random_network(shape, 6);
  model.network.geometry.beam_width_slopes = {0.01, 0.02};
  model.definition = "of a family\nin lines\n";
  write_model(path, model);
  EXPECT_EQ(files::Hdf5Reader(path).integer_attribute("/", "version"), 4)
      << "an older program would take the beams for constant ones";
  const auto back = read_model(path);
  EXPECT_EQ(back.definition, model.definition);
  EXPECT_EQ(back.network.geometry.beam_width_slopes, model.network.geometry.beam_width_slopes);
}

TEST_F(ModelFile, AModelThatNeedsNothingNewIsWrittenAsOlderProgramsReadIt) {
  write_model(path, model);
  EXPECT_EQ(files::Hdf5Reader(path).integer_attribute("/", "version"), 1);
  model.network.shape.rest = RestForm::exact;
  write_model(path, model);
  EXPECT_EQ(files::Hdf5Reader(path).integer_attribute("/", "version"), 2);
}

TEST_F(ModelFile, ACorrectionOfTheMeshIsReadBack) {
  model.network.mesh_correction = Eigen::MatrixXd::Random(6, 6);
  write_model(path, model);
  EXPECT_EQ(files::Hdf5Reader(path).integer_attribute("/", "version"), 3);
  EXPECT_EQ(read_model(path).network.mesh_correction, model.network.mesh_correction);
}

TEST_F(ModelFile, TheSameModelGivesTheSameBytes) {
  write_model(path, model);
  write_model(folder / "again.h5", model);
  EXPECT_EQ(content(path), content(folder / "again.h5"));
}

TEST_F(ModelFile, WhatIsNoModelIsRefused) {
  EXPECT_EQ(code_of(folder / "missing.h5"), "file.unreadable");
  std::ofstream(folder / "text.h5") << "not HDF5";
  EXPECT_EQ(code_of(folder / "text.h5"), "file.unreadable");
  write_model(path, model);
  const auto bytes = content(path);
  std::ofstream(folder / "cut.h5", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  EXPECT_EQ(code_of(folder / "cut.h5"), "file.unreadable");
}

TEST_F(ModelFile, AnyChangedByteIsNoticedBeforeItIsRead) {
  write_model(path, model);
  const auto bytes = content(path);
  RandomStream stream("damage", 1);
  for (int trial = 0; trial < 200; ++trial) {
    auto damaged = bytes;
    const auto place = static_cast<std::size_t>(stream.uniform() * static_cast<double>(bytes.size()));
    damaged[place] = static_cast<char>(damaged[place] ^ (1 << stream.below(8)));
    std::ofstream(folder / "damaged.h5", std::ios::binary) << damaged;
    ASSERT_EQ(code_of(folder / "damaged.h5"), "file.unreadable") << "byte " << place;
  }
}

TEST_F(ModelFile, IsReadFromBytesAsFromTheFile) {
  write_model(path, model);
  const std::string bytes = content(path);
  // The name is used in messages only, even if there is a file of that name.
  for (const std::string& name : {std::string("a name"), path.string()}) {
    write_model(folder / "again.h5", read_model(bytes, name));
    EXPECT_EQ(content(folder / "again.h5"), bytes) << name;
  }
  for (const std::string& wrong : {std::string(), bytes.substr(1), bytes.substr(0, bytes.size() - 1), "x" + bytes})
    testing::expect_error("file.unreadable", [&] { (void)read_model(wrong, "a name"); });
}

/// Models are read in a helper process until the end of a test.
class ModelFileInAHelper : public ModelFile {
 protected:
  ModelFileInAHelper() {
    use_helper_processes(std::make_shared<HelperProcesses>(HelperOptions{SUPPLE_HELPER, 1, 1ULL << 30U}));
  }
  ~ModelFileInAHelper() override { use_helper_processes(nullptr); }

  std::mutex mutex;
  std::condition_variable read;
  int trial_read = 0;

  /// The bytes with a valid checksum at their end.
  std::string sealed(const std::string& bytes) const {
    const auto file = folder / "sealed.h5";
    std::ofstream(file, std::ios::binary) << bytes;
    files::seal(file);
    return content(file);
  }
};

TEST_F(ModelFileInAHelper, IsTheModelThatIsReadHere) {
  write_model(path, model);
  const std::string bytes = content(path);
  write_model(folder / "again.h5", read_model(bytes, "its name"));
  EXPECT_EQ(content(folder / "again.h5"), bytes);
}

// A forged file may make the library crash. This process must go on, and whatever it reads must be a valid model.
TEST_F(ModelFileInAHelper, AForgedOneHarmsTheHelperAlone) {
  write_model(path, model);
  const std::string bytes = content(path);
  const std::size_t seal = bytes.rfind("\nsupple CRC-32");
  RandomStream stream("forged", 1);
  int refused = 0;
  for (int trial = 0; trial < 60; ++trial) {
    std::string forged = bytes.substr(0, seal);
    for (int k = 0; k < 3; ++k) {
      const auto place = static_cast<std::size_t>(stream.uniform() * std::min<double>(4096, forged.size()));
      forged[place] = static_cast<char>(stream.below(256));
    }
    // If a file makes the library run for ever, its caller stops it.
    const Execution execution;
    std::thread patience([&, token = execution.cancellation] {
      std::unique_lock lock(mutex);
      if (!read.wait_for(lock, std::chrono::seconds(20), [&] { return trial_read > trial; }))
        token.request(StopReason::deadline);
    });
    try {
      (void)read_model(sealed(forged), "forged", execution);
    } catch (const Error& error) {
      ++refused;
      EXPECT_TRUE(error.code() == "file.unreadable" || error.code().starts_with("model.") ||
                  error.code() == "server.out_of_memory")
          << error.code() << ": " << error.what();
    } catch (const Cancelled& stop) {
      ++refused;
      EXPECT_EQ(stop.reason(), StopReason::deadline);
    }
    {
      const std::lock_guard lock(mutex);
      trial_read = trial + 1;
    }
    read.notify_all();
    patience.join();
  }
  EXPECT_GT(refused, 5);
  EXPECT_EQ(read_model(bytes, "its name").id, model.id) << "the next file is read as ever";
}

TEST_F(ModelFile, AWideNetworkIsReadBack) {
  NetworkShape shape;
  shape.width = 640;
  shape.strain_layers = shape.parameter_layers = shape.trunk_layers = 1;
  model.network = random_network(shape, 1);
  write_model(path, model);
  EXPECT_EQ(read_model(path).network.trunk[0].weights, model.network.trunk[0].weights);
}

TEST_F(ModelFile, AnIdThatIsNoPartOfAnAddressIsRefused) {
  for (const char* id : {"", "IH67", "a/b", "..", "a b"}) {
    model.id = id;
    EXPECT_THROW(write_model(path, model), Error) << id;
  }
}

TEST_F(ModelFile, ANetworkThatDoesNotFitIsNotWritten) {
  model.network.trunk[1].bias.conservativeResize(23);
  EXPECT_THROW(write_model(path, model), Error);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(InRange, NeedsParametersStrainAndEnergyWithinWhatWasTrained) {
  Model model;
  model.network.lower = Eigen::Vector2d(0.1, 0.6);
  model.network.upper = Eigen::Vector2d(0.3, 1.1);
  model.strain_range = {-0.2, 0.5, 0.1};
  const std::vector<double> inside{0.1, 1.1};
  const Eigen::Vector3d strain(0.3, -0.1, 0.1);
  EXPECT_TRUE(in_range(model, inside, strain, 0.15, 2));
  EXPECT_FALSE(in_range(model, std::vector{0.09, 1.0}, strain, 0.15, 2));
  EXPECT_FALSE(in_range(model, inside, strain, 0.25, 2)) << "energy above 0.1 of the stiffness 2";
  EXPECT_FALSE(in_range(model, inside, Eigen::Vector3d(0.4, 0.4, 0.3), 0.15, 2)) << "principal strain 0.55";
  EXPECT_FALSE(in_range(model, inside, Eigen::Vector3d(0, -0.21, 0), 0.15, 2));
}

}  // namespace
}  // namespace supple::neural
