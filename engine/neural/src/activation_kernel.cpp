// Only inlined functions pass packs by value here, so that their calling convention does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"
#include "activation_kernel.h"

#include "supple/neural/activation_packs.h"

namespace supple::neural {
namespace {

template <class Real, Activation A, int Order>
SUPPLE_INLINE void forward(const Real* bias, const JetBlock<Real>& z, const JetBlock<Real>& a) {
  for (int jet = 0; jet < z.jets; ++jet) {
    Real* z_of[channels_of_order[Order]];
    Real* a_of[channels_of_order[Order]];
    for (int c = 0; c < channels_of_order[Order]; ++c) {
      z_of[c] = z.channel(c, jet);
      a_of[c] = a.channel(c, jet);
    }
    for (int row = 0; row < z.rows; row += Packs<Real>::count) {
      Pack<Real> f[4];
      derivatives_of<Real, A>(load_pack<Real>(z_of[0] + row) + load_pack<Real>(bias + row), Order + 1, f);
      store_pack<Real>(a_of[0] + row, f[0]);
      store_pack<Real>(z_of[0] + row, f[1]);
      if constexpr (Order > 0) {
        Pack<Real> first[3];
        for (int i = 0; i < 3; ++i) {
          first[i] = load_pack<Real>(z_of[1 + i] + row);
          store_pack<Real>(a_of[1 + i] + row, f[1] * first[i]);
          store_pack<Real>(z_of[1 + i] + row, f[2] * first[i]);
        }
        if constexpr (Order > 1) {
          for (int i = 0; i < 3; ++i) {
            for (int j = i; j < 3; ++j) {
              const int c = second_channel[i][j];
              const Pack<Real> second = load_pack<Real>(z_of[c] + row);
              const Pack<Real> product = first[i] * first[j];
              store_pack<Real>(a_of[c] + row, f[1] * second + f[2] * product);
              store_pack<Real>(z_of[c] + row, f[2] * second + f[3] * product);
            }
          }
        }
      }
    }
  }
}

template <class Real, int Order>
SUPPLE_INLINE void backward(const JetBlock<Real>& slope, const JetBlock<Real>& a) {
  for (int jet = 0; jet < a.jets; ++jet) {
    for (int row = 0; row < a.rows; row += Packs<Real>::count) {
      const Pack<Real> g = load_pack<Real>(slope.channel(0, jet) + row);
      const Pack<Real> u = load_pack<Real>(a.channel(0, jet) + row);
      store_pack<Real>(a.channel(0, jet) + row, u * g);
      if constexpr (Order > 0) {
        Pack<Real> g_first[3];
        Pack<Real> u_first[3];
        for (int i = 0; i < 3; ++i) {
          g_first[i] = load_pack<Real>(slope.channel(1 + i, jet) + row);
          u_first[i] = load_pack<Real>(a.channel(1 + i, jet) + row);
          store_pack<Real>(a.channel(1 + i, jet) + row, u_first[i] * g + u * g_first[i]);
        }
        if constexpr (Order > 1) {
          for (int i = 0; i < 3; ++i) {
            for (int j = i; j < 3; ++j) {
              const int c = second_channel[i][j];
              const Pack<Real> g_second = load_pack<Real>(slope.channel(c, jet) + row);
              const Pack<Real> u_second = load_pack<Real>(a.channel(c, jet) + row);
              store_pack<Real>(a.channel(c, jet) + row,
                               u_second * g + u_first[i] * g_first[j] + u_first[j] * g_first[i] + u * g_second);
            }
          }
        }
      }
    }
  }
}

template <class Real, Activation A>
SUPPLE_INLINE void forward_of_order(int order, const Real* bias, const JetBlock<Real>& z, const JetBlock<Real>& a) {
  switch (order) {
    case 0:
      return forward<Real, A, 0>(bias, z, a);
    case 1:
      return forward<Real, A, 1>(bias, z, a);
    default:
      return forward<Real, A, 2>(bias, z, a);
  }
}

template <class Real>
SUPPLE_INLINE void forward_all(Activation activation, int order, const Real* bias, const JetBlock<Real>& z,
                               const JetBlock<Real>& a) {
  switch (activation) {
    case Activation::swish:
      return forward_of_order<Real, Activation::swish>(order, bias, z, a);
    case Activation::tanh:
      return forward_of_order<Real, Activation::tanh>(order, bias, z, a);
    case Activation::sine:
      return forward_of_order<Real, Activation::sine>(order, bias, z, a);
  }
}
template <class Real>
SUPPLE_INLINE void backward_all(int order, const JetBlock<Real>& slope, const JetBlock<Real>& a) {
  switch (order) {
    case 0:
      return backward<Real, 0>(slope, a);
    case 1:
      return backward<Real, 1>(slope, a);
    default:
      return backward<Real, 2>(slope, a);
  }
}
template <class Real>
SUPPLE_AVX2 void forward_avx2(Activation activation, int order, const Real* bias, const JetBlock<Real>& z,
                              const JetBlock<Real>& a) {
  forward_all(activation, order, bias, z, a);
}
template <class Real>
SUPPLE_AVX2 void backward_avx2(int order, const JetBlock<Real>& slope, const JetBlock<Real>& a) {
  backward_all(order, slope, a);
}
}  // namespace

template <class Real>
void activate_forward(Activation activation, int order, const Real* bias, const JetBlock<Real>& z,
                      const JetBlock<Real>& a) {
  if (has_avx2)
    forward_avx2(activation, order, bias, z, a);
  else
    forward_all(activation, order, bias, z, a);
}
template <class Real>
void activate_backward(int order, const JetBlock<Real>& slope, const JetBlock<Real>& a) {
  if (has_avx2)
    backward_avx2(order, slope, a);
  else
    backward_all(order, slope, a);
}

template void activate_forward(Activation, int, const double*, const JetBlock<double>&, const JetBlock<double>&);
template void activate_forward(Activation, int, const float*, const JetBlock<float>&, const JetBlock<float>&);
template void activate_backward(int, const JetBlock<double>&, const JetBlock<double>&);
template void activate_backward(int, const JetBlock<float>&, const JetBlock<float>&);

}  // namespace supple::neural
