#include "training_batches.h"

#include <Eigen/LU>
#include <utility>

namespace supple::training {
namespace {

using torch::Tensor;

/// Columns become rows.
Tensor rows_of(const Eigen::Ref<const Eigen::MatrixXd>& columns, torch::Device device) {
  auto tensor = torch::empty({columns.cols(), columns.rows()}, torch::kDouble);
  Eigen::Map<Eigen::MatrixXd>(tensor.data_ptr<double>(), columns.rows(), columns.cols()) = columns;
  return tensor.to(device, torch::kFloat).contiguous();
}

Eigen::MatrixXd mapped_parameters(const Samples& samples) {
  const auto n = static_cast<long>(samples.designs.size());
  const auto parameters = static_cast<long>(samples.lower.size());
  Eigen::MatrixXd p(parameters, n);
  for (long d = 0; d < n; ++d)
    for (long k = 0; k < parameters; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double value = samples.designs[static_cast<std::size_t>(d)].parameters[i];
      p(k, d) = 2 * (value - samples.lower[i]) / (samples.upper[i] - samples.lower[i]) - 1;
    }
  return p;
}

/// Matrices as one tensor, matrices x 3 x 3.
Tensor stacked(const std::vector<Eigen::Matrix3d>& matrices, const torch::TensorOptions& options) {
  auto tensor = torch::empty({static_cast<long>(matrices.size()), 3, 3}, torch::kDouble);
  auto* to = tensor.data_ptr<double>();
  for (const auto& matrix : matrices)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) *to++ = matrix(i, j);
  return tensor.to(options);
}

/// 11, 12, 13, 22, 23, 33 as a full matrix.
Tensor full(const Tensor& six) {
  const auto column = [&](int i) { return six.select(1, i); };
  return torch::stack(
             {column(0), column(1), column(2), column(1), column(3), column(4), column(2), column(4), column(5)}, 1)
      .reshape({-1, 3, 3});
}

template <class T>
void shuffle(std::vector<T>& items, RandomStream& stream) {
  for (std::size_t i = items.size(); i > 1; --i)
    std::swap(items[i - 1], items[static_cast<std::size_t>(stream.below(static_cast<int>(i)))]);
}

}  // namespace

std::vector<Chunk> chunks_by_design(const Samples& samples, const std::vector<int>& rows) {
  std::vector<Chunk> designs;
  int design = 0;
  for (const int row : rows) {
    while (row >= samples.designs[static_cast<std::size_t>(design)].first +
                      samples.designs[static_cast<std::size_t>(design)].count)
      ++design;
    if (designs.empty() || designs.back().design != design) designs.push_back({design, {}});
    designs.back().rows.push_back(row);
  }
  return designs;
}

std::vector<Chunk> shuffled_chunks(const std::vector<Chunk>& designs, int chunk_rows, RandomStream& stream) {
  std::vector<Chunk> chunks;
  for (auto [design, rows] : designs) {
    shuffle(rows, stream);
    const auto n = rows.size();
    const auto pieces = (n + static_cast<std::size_t>(chunk_rows) - 1) / static_cast<std::size_t>(chunk_rows);
    for (std::size_t i = 0; i < pieces; ++i)
      chunks.push_back(
          {design,
           {rows.begin() + static_cast<long>(i * n / pieces), rows.begin() + static_cast<long>((i + 1) * n / pieces)}});
  }
  shuffle(chunks, stream);
  return chunks;
}

TrainingData::TrainingData(const Samples& samples, const std::vector<Eigen::Matrix3d>& symmetries, torch::Device device)
    : p_(rows_of(mapped_parameters(samples), device)),
      strain_(rows_of(samples.strain, device)),
      stress_(rows_of(samples.stress, device)),
      energy_(rows_of(samples.energy, device).squeeze(1)),
      tangent_(rows_of(samples.tangent, device)),
      symmetries_(1 + static_cast<int>(symmetries.size())) {
  std::vector<Eigen::Matrix3d> strain_maps{Eigen::Matrix3d::Identity()};
  std::vector<Eigen::Matrix3d> stress_maps{Eigen::Matrix3d::Identity()};
  for (const auto& map : symmetries) {
    strain_maps.push_back(map);
    stress_maps.emplace_back(map.inverse().transpose());
  }
  strain_maps_ = stacked(strain_maps, strain_.options());
  stress_maps_ = stacked(stress_maps, strain_.options());
}

LabelledBatch TrainingData::labelled(std::span<const Chunk> chunks, std::span<const int> symmetry) const {
  std::vector<std::int64_t> rows;
  std::vector<std::int64_t> of;
  std::vector<std::int64_t> designs;
  std::vector<std::int64_t> seen_through;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    for (const auto row : chunks[i].rows) {
      rows.push_back(row);
      of.push_back(static_cast<std::int64_t>(i));
      seen_through.push_back(symmetry[i]);
    }
    designs.push_back(chunks[i].design);
  }
  const auto device = strain_.device();
  const auto index = torch::tensor(rows).to(device);
  auto e = strain_.index_select(0, index);
  auto stress = stress_.index_select(0, index);
  auto tangent = full(tangent_.index_select(0, index));
  if (symmetries_ > 1) {
    const auto which = torch::tensor(seen_through).to(device);
    const auto strain_map = strain_maps_.index_select(0, which);
    const auto stress_map = stress_maps_.index_select(0, which);
    e = (strain_map * e.unsqueeze(1)).sum(2);
    stress = (stress_map * stress.unsqueeze(1)).sum(2);
    tangent = (stress_map.unsqueeze(3) * tangent.unsqueeze(1)).sum(2);
    tangent = (tangent.unsqueeze(2) * stress_map.unsqueeze(1)).sum(3);
  }
  return {{p_.index_select(0, torch::tensor(designs).to(device)), torch::tensor(of).to(device), e},
          energy_.index_select(0, index),
          stress,
          tangent};
}

}  // namespace supple::training
