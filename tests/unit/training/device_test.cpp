// A training step with tensors that have shapes and a device but no data. LibTorch refuses operations between devices.
// The test therefore finds, without a GPU, any tensor that is created on the wrong device.
#include <gtest/gtest.h>
#include <torch/library.h>
#include <torch/torch.h>

#include <array>

#include "optimizer.h"
#include "row_losses.h"
#include "support/expect_error.h"
#include "support/law_samples.h"
#include "support/random_network.h"
#include "torch_network.h"
#include "training_batches.h"

namespace supple::training {
namespace {

// LibTorch 1.13 lacks these operations for tensors without data. Later versions have them.
#if TORCH_VERSION_MAJOR < 2
torch::Tensor select_without_numbers(const torch::Tensor& from, std::int64_t dimension, const torch::Tensor& index) {
  TORCH_CHECK(from.device() == index.device(), "index_select: tensors on two devices");
  auto sizes = from.sizes().vec();
  sizes[static_cast<std::size_t>(dimension)] = index.numel();
  return torch::empty(sizes, from.options());
}
torch::Tensor& and_without_numbers(const torch::Tensor& a, const torch::Tensor& b, torch::Tensor& result) {
  TORCH_CHECK(a.device() == b.device(), "logical_and: tensors on two devices");
  return result;
}
torch::Tensor where_without_numbers(const torch::Tensor& condition, const torch::Tensor& a, const torch::Tensor& b) {
  for (const auto& tensor : {a, b})
    TORCH_CHECK(tensor.dim() == 0 || tensor.device() == condition.device(), "where: tensors on two devices");
  return torch::empty(condition.sizes(), (a.dim() > 0 ? a : b).options());
}
TORCH_LIBRARY_IMPL(aten, Meta, library) {
  library.impl("where.self", where_without_numbers);
  library.impl("index_select", select_without_numbers);
  library.impl("logical_and.out", and_without_numbers);
}
#endif

class OnAnotherDevice : public ::testing::TestWithParam<neural::NetworkShape> {};

TEST_P(OnAnotherDevice, AllTensorsOfAStepMeet) {
  const torch::Device device = torch::kMeta;
  const auto& shape = GetParam();
  const auto samples = law_samples(4, 5, 1);
  const EnergySymmetry mirror{Eigen::Vector3d(1, 1, -1).asDiagonal(), -Eigen::MatrixXd::Identity(1, 1),
                              Eigen::VectorXd::Constant(1, 1)};
  const TrainingData data(samples, {mirror}, {}, {}, device);
  const std::vector<Chunk> chunks{{0, {0, 1, 2}}, {2, {10, 11}}};
  const std::array seen{0, 1};
  const auto rows = data.labelled(chunks, seen);
  auto parameters = to_parameters(neural::random_network(shape, 1), torch::kFloat, device);
  for (auto& parameter : parameters) parameter.set_requires_grad(true);
  const auto unit_vectors = torch::ones({5, 3}, torch::kDouble).to(data.tensor_options());
  for (const bool with_tangents : {false, true}) {
    torch::Tensor directions;
    if (with_tangents) directions = (rows.whitening * unit_vectors.unsqueeze(1)).sum(2);
    for (const auto loss : {LossKind::robust, LossKind::squared}) {
      TrainingOptions options;
      options.loss = loss;
      const auto losses = row_losses(options, response(shape, parameters, rows.batch, directions), rows, directions);
      EXPECT_EQ(losses.device().type(), torch::kMeta);
      losses.sum().backward();
    }
  }
  std::vector<torch::Tensor> gradients;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    gradients.push_back(parameters[i].grad().defined() ? parameters[i].grad() : torch::zeros_like(parameters[i]));
    EXPECT_EQ(gradients.back().device().type(), torch::kMeta) << "parameter " << i;
  }
  Parameters trained;
  for (const auto& parameter : parameters) trained.push_back(parameter.detach());
  Optimizer optimizer(OptimizerKind::adam, trained, trained.size(), 0.01);
  optimizer.step(gradients, 0.01);
  for (const auto& [name, tensor] : optimizer.state()) EXPECT_EQ(tensor.device().type(), torch::kMeta) << name;
}

neural::NetworkShape shape_of_device_test(neural::EnergyForm form, neural::RestForm rest) {
  neural::NetworkShape shape;
  shape.width = 32;
  shape.parameters = 1;
  shape.form = form;
  shape.rest = rest;
  return shape;
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, OnAnotherDevice,
    ::testing::Values(shape_of_device_test(neural::EnergyForm::sum_of_squares, neural::RestForm::free),
                      shape_of_device_test(neural::EnergyForm::sum_of_squares, neural::RestForm::exact),
                      shape_of_device_test(neural::EnergyForm::softplus, neural::RestForm::free)));

TEST(Device, OneThatIsNotThereIsAnErrorAndAutomaticIsWhatThereIs) {
  const auto samples = law_samples(20, 4, 1);
  const auto parts = split(samples, {.validation = 0.1, .test = 0.1, .row_test = 0, .seed = 1});
  TrainingOptions options;
  options.shape.width = 16;
  options.shape.parameters = 1;
  options.epochs = 1;
  const auto used = [&](DeviceKind kind) {
    options.device = kind;
    return train(samples, parts, options, {}, {}, [](const auto&) {}).device;
  };
  EXPECT_EQ(used(DeviceKind::cpu), DeviceKind::cpu);
  if (torch::cuda::is_available()) {
    EXPECT_EQ(used(DeviceKind::automatic), DeviceKind::cuda);
    EXPECT_EQ(used(DeviceKind::cuda), DeviceKind::cuda);
    return;
  }
  EXPECT_EQ(used(DeviceKind::automatic), DeviceKind::cpu);
  const auto error = testing::expect_error("training.no_device", [&] { (void)used(DeviceKind::cuda); });
  EXPECT_EQ(testing::places(error), std::vector<std::string>{"device"});
}

}  // namespace
}  // namespace supple::training
