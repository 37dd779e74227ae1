#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

// Lists of vectors and of indices as matrices with one row for each entry, as other libraries of geometry have them.
namespace supple::numerics {

/// The matrix whose rows are these vectors.
template <int dimension>
Eigen::MatrixXd rows_of(const std::vector<Eigen::Matrix<double, dimension, 1>>& vectors) {
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(vectors.size()), dimension);
  for (std::size_t i = 0; i < vectors.size(); ++i) matrix.row(static_cast<Eigen::Index>(i)) = vectors[i].transpose();
  return matrix;
}

/// The matrix whose rows are these groups of indices, such as the corners of faces.
template <std::size_t size>
Eigen::MatrixXi rows_of(const std::vector<std::array<int, size>>& groups) {
  Eigen::MatrixXi matrix(static_cast<Eigen::Index>(groups.size()), static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < groups.size(); ++i)
    matrix.row(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::RowVectorXi>(groups[i].data(), size);
  return matrix;
}

/// Throws std::invalid_argument, which calls the matrix `name`, if it does not have this number of columns.
inline void require_columns(Eigen::Index columns, Eigen::Index wanted, const std::string& name) {
  if (columns != wanted)
    throw std::invalid_argument("The matrix of " + name + " has " + std::to_string(columns) + " columns, not " +
                                std::to_string(wanted) + ".");
}

/// The rows of a matrix as vectors. Throws what require_columns throws.
template <int dimension>
std::vector<Eigen::Matrix<double, dimension, 1>> vectors_of(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                                                            const std::string& name) {
  require_columns(matrix.cols(), dimension, name);
  std::vector<Eigen::Matrix<double, dimension, 1>> vectors(static_cast<std::size_t>(matrix.rows()));
  for (std::size_t i = 0; i < vectors.size(); ++i) vectors[i] = matrix.row(static_cast<Eigen::Index>(i)).transpose();
  return vectors;
}

/// The rows of a matrix as groups of indices. Throws what require_columns throws.
template <std::size_t size>
std::vector<std::array<int, size>> groups_of(const Eigen::Ref<const Eigen::MatrixXi>& matrix, const std::string& name) {
  require_columns(matrix.cols(), static_cast<Eigen::Index>(size), name);
  std::vector<std::array<int, size>> groups(static_cast<std::size_t>(matrix.rows()));
  for (std::size_t i = 0; i < groups.size(); ++i)
    Eigen::Map<Eigen::RowVectorXi>(groups[i].data(), size) = matrix.row(static_cast<Eigen::Index>(i));
  return groups;
}

}  // namespace supple::numerics
