#pragma once

#include "supple/neural/network.h"
#include "supple/neural/packed_matrix.h"

namespace supple::neural {

/// Activations are propagated as jets: a value and its derivatives with respect to e = (e1, e2, e3). A jet of order 0
/// has one channel, the value. A jet of order 1 has four: also the derivatives 1, 2, 3. A jet of order 2 has ten: also
/// the derivatives 11, 12, 13, 22, 23, 33.
inline constexpr int channels_of_order[] = {1, 4, 10};
inline constexpr int max_channels = 10;
/// Channel of the second derivative ij of a jet of order 2.
inline constexpr int second_channel[3][3] = {{4, 5, 6}, {5, 7, 8}, {6, 8, 9}};

/// A block of jets: channel c of jet j begins at data + (c jets + j) stride and holds `rows` numbers, a multiple of
/// row_multiple.
template <class Real>
struct JetBlock {
  Real* data = nullptr;
  int jets = 0;
  int rows = 0;
  int stride = 0;

  Factor<Real> factor() const { return {data, stride}; }
  Real* channel(int c, int jet) const { return data + static_cast<std::ptrdiff_t>(c * jets + jet) * stride; }
};

/// Computes a = f(z + bias). z becomes the jet of f'(z + bias), which `activate_backward` needs. The bias is added to
/// values only. A number takes about 20 flops and an exponential, and 2 to 6 flops for each further channel.
template <class Real>
void activate_forward(Activation activation, int order, const Real* bias, const JetBlock<Real>& z,
                      const JetBlock<Real>& a);

/// The adjoint of activate_forward. `a` has the jets of the energy's derivatives with respect to f(z), and gets those
/// of its derivatives with respect to z. `slope` has the jets of f'.
template <class Real>
void activate_backward(int order, const JetBlock<Real>& slope, const JetBlock<Real>& a);

}  // namespace supple::neural
