// Files that are exchanged with another trainer. If Python has PyTorch and h5py, the PyTorch trainer is compared with
// ours: its answers, its loss, its gradient, and the file that it writes.
#include "training_set.h"

#include <gtest/gtest.h>
#include <torch/autograd.h>
#include <torch/types.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>

#include "checkpoint.h"
#include "row_losses.h"
#include "supple/files/hdf5_file.h"
#include "support/expect_error.h"
#include "support/law_samples.h"
#include "support/random_network.h"
#include "support/temporary_folder.h"
#include "torch_network.h"
#include "training_batches.h"

namespace supple::training {
namespace {

constexpr int designs = 6;
constexpr int rows = 11;

Split all_of(const Samples& samples) {
  Split split;
  split.training.resize(static_cast<std::size_t>(samples.rows()));
  std::iota(split.training.begin(), split.training.end(), 0);
  return split;
}

TrainingOptions options_of(neural::RestForm rest, const Samples& samples) {
  TrainingOptions options;
  options.shape.width = 48;
  options.shape.parameters = 1;
  options.shape.stiffness_width = 24;
  options.shape.rest = rest;
  options.chunk_rows = rows;
  options.batch_chunks = designs;
  options.symmetries = {{Eigen::Vector3d(1, 1, -1).asDiagonal(), -Eigen::MatrixXd::Identity(1, 1),
                         Eigen::VectorXd::Constant(1, samples.lower[0] + samples.upper[0])}};
  return options;
}

/// Writes a network in the layout of a file of the PyTorch trainer.
void write_as_trained(const std::filesystem::path& path, const Samples& samples, const TrainingOptions& options,
                      const neural::Network& network) {
  files::Hdf5Writer file(path);
  file.attribute("/", "layout", "supple trained network");
  file.attribute("/", "version", std::int64_t{1});
  std::vector<std::string> lines;
  for (const auto& [name, value] : identity(samples, all_of(samples), options, {})) lines.push_back(name + "=" + value);
  file.column("options", lines);
  file.column("training", std::vector<std::string>{"epochs=7", "trainer=a test"});
  file.value("seconds", 3.5);
  Checkpoint::Tensors tensors;
  for (const auto& tensor : to_parameters(network, torch::kFloat, torch::kCPU))
    tensors.emplace_back(std::to_string(tensors.size()), tensor);
  write_tensors(file, "network", tensors);
  file.close();
}

void expect_same(const neural::Network& a, const neural::Network& b) {
  const auto one = to_parameters(a, torch::kFloat, torch::kCPU);
  const auto two = to_parameters(b, torch::kFloat, torch::kCPU);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(torch::equal(one[i], two[i])) << "tensor " << i;
}

TEST(TrainedNetwork, OfTheSetIsReadWithHowItWasTrained) {
  const testing::TemporaryFolder folder;
  const auto samples = law_samples(designs, rows, 1);
  const auto options = options_of(neural::RestForm::free, samples);
  const auto network = neural::random_network(options.shape, 3);
  write_as_trained(folder / "trained.h5", samples, options, network);
  const auto trained = read_trained(folder / "trained.h5", samples, all_of(samples), options, {});
  expect_same(trained.network, network);
  EXPECT_EQ(trained.network.lower[0], samples.lower[0]);
  EXPECT_EQ(trained.seconds, 3.5);
  EXPECT_EQ(trained.options.at(0), std::make_pair(std::string("epochs"), std::string("7")));
}

TEST(TrainedNetwork, OfOtherOptionsOrDataOrOfAnotherShapeIsRefused) {
  const testing::TemporaryFolder folder;
  const auto samples = law_samples(designs, rows, 1);
  const auto options = options_of(neural::RestForm::free, samples);
  const auto file = folder / "trained.h5";
  write_as_trained(file, samples, options, neural::random_network(options.shape, 3));
  const auto read = [&](const Samples& of, const TrainingOptions& with) {
    (void)read_trained(file, of, all_of(of), with, {});
  };
  auto other = options;
  other.weight_decay = 0.5;
  const auto error = testing::expect_error("training.different_options", [&] { read(samples, other); });
  EXPECT_EQ(testing::places(error), std::vector<std::string>{"weight_decay"});
  testing::expect_error("training.different_options", [&] { read(law_samples(designs, rows, 2), options); });
  auto narrow = options.shape;
  narrow.width = 32;
  write_as_trained(file, samples, options, neural::random_network(narrow, 3));
  testing::expect_error("file.unreadable", [&] { read(samples, options); });
  std::ofstream(file) << "no HDF5";
  testing::expect_error("file.unreadable", [&] { read(samples, options); });
}

/// Whether this machine's Python can run the trainer.
bool python_has_torch() { return std::system("python3 -c 'import torch, h5py' > /dev/null 2>&1") == 0; }

class PytorchTrainer : public ::testing::TestWithParam<neural::RestForm> {};

TEST_P(PytorchTrainer, HasTheAnswersTheLossAndTheGradientOfOurs) {
  if (!python_has_torch()) GTEST_SKIP() << "python3 has no torch or no h5py";
  const testing::TemporaryFolder folder;
  const auto samples = law_samples(designs, rows, 1);
  const auto options = options_of(GetParam(), samples);
  const auto network = neural::random_network(options.shape, 5);
  const auto split = all_of(samples);
  write_training_set(folder / "set.h5", samples, split, options, {}, network);

  const TrainingData data(samples, options.symmetries, {}, {}, torch::kCPU);
  const auto chunks = chunks_by_design(samples, split.training);
  std::vector<int> symmetry;
  for (const auto& chunk : chunks) symmetry.push_back(data.symmetries_of(chunk.design).at(chunk.design % 2));
  RandomStream stream("unit vectors", 1);
  std::vector<double> unit;
  for (int i = 0; i < samples.rows(); ++i) {
    const Eigen::Vector3d v = Eigen::Vector3d(stream.normal(), stream.normal(), stream.normal()).normalized();
    unit.insert(unit.end(), v.begin(), v.end());
  }
  const auto unit_vectors = torch::tensor(unit, torch::kDouble).reshape({-1, 3}).to(torch::kFloat);
  const auto batch = data.labelled(chunks, symmetry);
  const auto directions = (batch.whitening * unit_vectors.unsqueeze(1)).sum(2);
  auto parameters = to_parameters(network, torch::kFloat, torch::kCPU);
  for (auto& tensor : parameters) tensor.set_requires_grad(true);
  const auto answer = response(options.shape, parameters, batch.batch, directions);
  const auto loss = row_losses(options, answer, batch, directions).mean();
  loss.backward();
  {
    files::Hdf5Writer file(folder / "reference.h5");
    file.column("symmetry", std::vector<std::int64_t>(symmetry.begin(), symmetry.end()), 0);
    file.column("unit", unit, 3);
    const auto add = [&](const char* name, const torch::Tensor& tensor, int columns) {
      const auto numbers = tensor.detach().to(torch::kDouble).contiguous();
      const auto* values = numbers.data_ptr<double>();
      file.column(name, std::vector<double>(values, values + numbers.numel()), columns);
    };
    add("energy", answer.energy, 1);
    add("stress", answer.stress, 3);
    add("along", answer.stiffness, 1);
    file.value("loss", loss.item<double>());
    file.group("gradient");
    for (std::size_t i = 0; i < parameters.size(); ++i)
      if (const auto& gradient = parameters[i].grad(); gradient.defined())
        add(("gradient/" + std::to_string(i)).c_str(), gradient.reshape({-1, 1}), 1);
    file.close();
  }
  const auto quoted = [](const std::filesystem::path& path) { return "'" + path.string() + "' "; };
  const auto output = folder / "output.txt";
  const int code =
      std::system(("python3 " + quoted(SUPPLE_COMPARE_PYTORCH) + quoted(folder / "set.h5") +
                   quoted(folder / "reference.h5") + quoted(folder / "trained.h5") + "> " + quoted(output) + "2>&1")
                      .c_str());
  std::ostringstream said;
  said << std::ifstream(output).rdbuf();
  ASSERT_EQ(code, 0) << said.str();
  expect_same(read_trained(folder / "trained.h5", samples, split, options, {}).network, network);
}

INSTANTIATE_TEST_SUITE_P(Rest, PytorchTrainer, ::testing::Values(neural::RestForm::free, neural::RestForm::exact),
                         [](const auto& rest) { return std::string(to_string(rest.param)); });

}  // namespace
}  // namespace supple::training
