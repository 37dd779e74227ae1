#include "training_batches.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "supple/neural/uniaxial_frame.h"

namespace supple::training {
namespace {

using torch::Tensor;

/// Copies columns into the rows of a tensor.
Tensor rows_of(const Eigen::Ref<const Eigen::MatrixXd>& columns, torch::Device device) {
  auto tensor = torch::empty({columns.cols(), columns.rows()}, torch::kDouble);
  Eigen::Map<Eigen::MatrixXd>(tensor.data_ptr<double>(), columns.rows(), columns.cols()) = columns;
  return tensor.to(device, torch::kFloat).contiguous();
}

/// Images of designs may lie outside of the box by this fraction of its width, as the designs of a data set do
/// (box_margin).
constexpr double image_margin = 0.05;
/// Parameters, mapped to [-1, 1], that differ by less belong to the same design.
constexpr double design_tolerance = 1e-6;

/// Absolute eigenvalues of a tangent are bounded below by this fraction of the largest one, because they vanish near
/// buckling.
constexpr double min_eigenvalue_ratio = 3e-4;

/// |C|^-1/2 of each tangent C. Entries of both are in the order 11, 12, 13, 22, 23, 33.
Eigen::MatrixXd whitenings(const Eigen::Matrix<double, 6, -1>& tangents) {
  Eigen::MatrixXd result(6, tangents.cols());
  for (long i = 0; i < tangents.cols(); ++i) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(neural::symmetric_matrix(tangents.col(i)));
    const Eigen::Array3d size = eigen.eigenvalues().array().abs();
    const Eigen::Array3d bounded = size.max(min_eigenvalue_ratio * size.maxCoeff());
    const Eigen::Matrix3d w =
        eigen.eigenvectors() * bounded.rsqrt().matrix().asDiagonal() * eigen.eigenvectors().transpose();
    result.col(i) << w(0, 0), w(0, 1), w(0, 2), w(1, 1), w(1, 2), w(2, 2);
  }
  return result;
}

/// Stacks matrices into one tensor, matrices x 3 x 3.
Tensor stacked(const std::vector<Eigen::Matrix3d>& matrices, const torch::TensorOptions& options) {
  auto tensor = torch::empty({static_cast<long>(matrices.size()), 3, 3}, torch::kDouble);
  auto* to = tensor.data_ptr<double>();
  for (const auto& matrix : matrices)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) *to++ = matrix(i, j);
  return tensor.to(options);
}

/// Symmetric 3 x 3 matrices from their entries 11, 12, 13, 22, 23, 33.
Tensor full_matrices(const Tensor& packed) {
  const auto column = [&](int i) { return packed.select(1, i); };
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

std::vector<EnergySymmetry> with_identity(const std::vector<EnergySymmetry>& symmetries, long parameters) {
  std::vector<EnergySymmetry> all{{Eigen::Matrix3d::Identity(), Eigen::MatrixXd::Identity(parameters, parameters),
                                   Eigen::VectorXd::Zero(parameters)}};
  all.insert(all.end(), symmetries.begin(), symmetries.end());
  return all;
}

Eigen::MatrixXd images(const Eigen::Ref<const Eigen::MatrixXd>& parameters, const EnergySymmetry& symmetry) {
  return (symmetry.linear * parameters).colwise() + symmetry.constant;
}

Eigen::MatrixXd design_inputs(const Samples& samples, const neural::TileGeometry& geometry,
                              const Eigen::Ref<const Eigen::MatrixXd>& parameters) {
  const auto n = parameters.rows();
  const Eigen::Map<const Eigen::ArrayXd> lower(samples.lower.data(), n);
  const Eigen::Map<const Eigen::ArrayXd> upper(samples.upper.data(), n);
  Eigen::MatrixXd inputs(n + static_cast<long>(geometry.features.size()), parameters.cols());
  for (long d = 0; d < inputs.cols(); ++d) {
    const Eigen::VectorXd own = parameters.col(d);
    inputs.col(d).head(n) = 2 * (own.array() - lower) / (upper - lower) - 1;
    if (!geometry.empty())
      inputs.col(d).tail(inputs.rows() - n) =
          neural::evaluate_features(geometry, {own.data(), static_cast<std::size_t>(n)}, false);
  }
  return inputs;
}

bool coincides(const Eigen::Ref<const Eigen::VectorXd>& design, const Eigen::Ref<const Eigen::MatrixXd>& others) {
  return others.cols() > 0 && (others.colwise() - design).cwiseAbs().colwise().maxCoeff().minCoeff() < design_tolerance;
}

bool usable_image(const Eigen::Ref<const Eigen::VectorXd>& own, const Eigen::Ref<const Eigen::VectorXd>& image,
                  const Eigen::Ref<const Eigen::MatrixXd>& held_out) {
  if (coincides(image, held_out)) return false;
  const double extent = own.cwiseAbs().maxCoeff();
  return image.cwiseAbs().maxCoeff() <= std::max(extent, 1 + 2 * image_margin) + design_tolerance;
}

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
    const auto chunk_count = (n + static_cast<std::size_t>(chunk_rows) - 1) / static_cast<std::size_t>(chunk_rows);
    for (std::size_t i = 0; i < chunk_count; ++i)
      chunks.push_back({design,
                        {rows.begin() + static_cast<long>(i * n / chunk_count),
                         rows.begin() + static_cast<long>((i + 1) * n / chunk_count)}});
  }
  shuffle(chunks, stream);
  return chunks;
}

TrainingData::TrainingData(const Samples& samples, const std::vector<EnergySymmetry>& symmetries,
                           const std::vector<int>& held_out, const neural::TileGeometry& geometry, torch::Device device)
    : designs_(static_cast<std::int64_t>(samples.designs.size())),
      strain_(rows_of(samples.strain, device)),
      stress_(rows_of(samples.stress, device)),
      energy_(rows_of(samples.energy, device).squeeze(1)),
      tangent_(rows_of(samples.tangent, device)),
      whitening_(rows_of(whitenings(samples.tangent), device)),
      usable_symmetries_(samples.designs.size(), std::vector<int>{0}) {
  const auto n = static_cast<long>(samples.lower.size());
  Eigen::MatrixXd parameters(n, static_cast<long>(samples.designs.size()));
  for (long d = 0; d < parameters.cols(); ++d)
    parameters.col(d) =
        Eigen::Map<const Eigen::VectorXd>(samples.designs[static_cast<std::size_t>(d)].parameters.data(), n);
  const Eigen::MatrixXd own = design_inputs(samples, {}, parameters);
  const Eigen::MatrixXd held_out_inputs = own(Eigen::all, held_out);
  std::vector<Eigen::Matrix3d> strain_maps;
  std::vector<Tensor> inputs;
  for (const auto& symmetry : with_identity(symmetries, n)) {
    strain_maps.push_back(symmetry.strain);
    stress_map_matrices_.emplace_back(symmetry.strain.inverse().transpose());
    const auto p = design_inputs(samples, geometry, images(parameters, symmetry));
    inputs.push_back(rows_of(p, device));
    if (inputs.size() == 1) continue;
    for (long d = 0; d < p.cols(); ++d)
      if (usable_image(own.col(d), p.col(d).head(n), held_out_inputs))
        usable_symmetries_[static_cast<std::size_t>(d)].push_back(static_cast<int>(inputs.size()) - 1);
  }
  inputs_ = torch::cat(inputs);
  strain_maps_ = stacked(strain_maps, strain_.options());
  stress_maps_ = stacked(stress_map_matrices_, strain_.options());
}

Tensor TrainingData::parameters(std::span<const DesignImage> designs) const {
  std::vector<std::int64_t> rows;
  for (const auto& [design, symmetry] : designs) rows.push_back(symmetry * designs_ + design);
  return inputs_.index_select(0, torch::tensor(rows).to(inputs_.device()));
}

std::vector<std::pair<std::string, Tensor>> TrainingData::tables() const {
  const auto symmetries = strain_maps_.size(0);
  auto is_usable = torch::zeros({designs_, symmetries});
  for (std::size_t d = 0; d < usable_symmetries_.size(); ++d)
    for (const int symmetry : usable_symmetries_[d]) is_usable.index_put_({static_cast<std::int64_t>(d), symmetry}, 1);
  return {{"inputs", inputs_},
          {"usable", is_usable},
          {"strain", strain_},
          {"stress", stress_},
          {"energy", energy_.unsqueeze(1)},
          {"tangent", tangent_},
          {"whitening", whitening_},
          {"strain_maps", strain_maps_.reshape({symmetries, 9})}};
}

LabelledBatch TrainingData::labelled(std::span<const Chunk> chunks, std::span<const int> symmetry) const {
  std::vector<std::int64_t> rows;
  std::vector<std::int64_t> design_of_row;
  std::vector<DesignImage> designs;
  std::vector<std::int64_t> row_symmetries;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    for (const auto row : chunks[i].rows) {
      rows.push_back(row);
      design_of_row.push_back(static_cast<std::int64_t>(i));
      row_symmetries.push_back(symmetry[i]);
    }
    designs.push_back({chunks[i].design, symmetry[i]});
  }
  const auto device = strain_.device();
  const auto index = torch::tensor(rows).to(device);
  auto e = strain_.index_select(0, index);
  auto stress = stress_.index_select(0, index);
  auto tangent = full_matrices(tangent_.index_select(0, index));
  auto whitening = full_matrices(whitening_.index_select(0, index));
  if (stress_map_matrices_.size() > 1) {
    const auto symmetry_index = torch::tensor(row_symmetries).to(device);
    const auto strain_map = strain_maps_.index_select(0, symmetry_index);
    const auto stress_map = stress_maps_.index_select(0, symmetry_index);
    e = (strain_map * e.unsqueeze(1)).sum(2);
    stress = (stress_map * stress.unsqueeze(1)).sum(2);
    tangent = (stress_map.unsqueeze(3) * tangent.unsqueeze(1)).sum(2);
    tangent = (tangent.unsqueeze(2) * stress_map.unsqueeze(1)).sum(3);
    whitening = (strain_map.unsqueeze(3) * whitening.unsqueeze(1)).sum(2);
  }
  return {{parameters(designs), torch::tensor(design_of_row).to(device), e},
          energy_.index_select(0, index),
          stress,
          tangent,
          whitening};
}

}  // namespace supple::training
