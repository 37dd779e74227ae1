#include "matrix_product.h"

#include <torch/types.h>

#include "supple/neural/packed_matrix.h"

namespace supple::training {

bool supported_by_kernels(const torch::Tensor& tensor) {
  return tensor.device().is_cpu() && tensor.scalar_type() == torch::kFloat;
}

torch::Tensor product(const torch::Tensor& a, bool transpose_a, const torch::Tensor& b, bool transpose_b) {
  if (!supported_by_kernels(a) || !supported_by_kernels(b))
    return torch::mm(transpose_a ? a.t() : a, transpose_b ? b.t() : b);
  const auto left = a.contiguous();
  const auto right = b.contiguous();
  const auto rows = transpose_a ? left.size(1) : left.size(0);
  const auto depth = transpose_a ? left.size(0) : left.size(1);
  const auto columns = transpose_b ? right.size(0) : right.size(1);
  // The kernel stores its result by columns. It computes right^T left^T, whose columns are the rows of the product.
  neural::PackedMatrix<float> packed;
  const int stride = static_cast<int>(right.size(1));
  packed.assign(right.data_ptr<float>(), static_cast<int>(columns), static_cast<int>(depth), stride, transpose_b);
  const int padded = neural::padded_rows(static_cast<int>(columns));
  auto result = torch::empty({rows, padded}, left.options());
  const auto width = static_cast<std::ptrdiff_t>(left.size(1));
  const neural::Factor<float> factor = transpose_a ? neural::Factor<float>{left.data_ptr<float>(), 1, width}
                                                   : neural::Factor<float>{left.data_ptr<float>(), width, 1};
  neural::multiply(packed, factor, static_cast<int>(rows), result.data_ptr<float>(), padded);
  return padded == columns ? result : result.narrow(1, 0, columns);
}

}  // namespace supple::training
