// No function outside of this file takes or returns packs by value, so that their calling convention does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"
#include "jet_kernel.h"

#include <algorithm>

#include "supple/neural/activation_packs.h"

namespace supple::training {
namespace {

using neural::Activation;
using neural::all_of;
using neural::load_pack;
using neural::store_pack;
using Pack = neural::Pack<float>;
constexpr int pack_size = neural::Packs<float>::count;

/// The jets of neighbouring neurons, as many as a pack has numbers. Only the channels that exist are set.
template <int Channels>
struct JetPack {
  Pack value;
  Pack first[3];
  Pack second;
};

template <int Channels>
SUPPLE_INLINE void load(const float* from, std::ptrdiff_t channel, JetPack<Channels>& jet) {
  jet.value = load_pack<float>(from);
  if constexpr (Channels > 1)
    for (int i = 0; i < 3; ++i) jet.first[i] = load_pack<float>(from + (1 + i) * channel);
  if constexpr (Channels > 4) jet.second = load_pack<float>(from + 4 * channel);
}
template <int Channels>
SUPPLE_INLINE void store(float* to, std::ptrdiff_t channel, const JetPack<Channels>& jet) {
  store_pack<float>(to, jet.value);
  if constexpr (Channels > 1)
    for (int i = 0; i < 3; ++i) store_pack<float>(to + (1 + i) * channel, jet.first[i]);
  if constexpr (Channels > 4) store_pack<float>(to + 4 * channel, jet.second);
}

template <Activation A, int Channels>
SUPPLE_INLINE void forward(const JetSizes& sizes, const float* v, const float* bias, const float* z, float* y) {
  const std::ptrdiff_t channel = static_cast<std::ptrdiff_t>(sizes.rows) * sizes.width;
  for (std::ptrdiff_t begin = 0; begin < channel; begin += sizes.width, v += 3) {
    for (int i = 0; i < sizes.width; i += pack_size) {
      JetPack<Channels> in;
      load(z + begin + i, channel, in);
      Pack f[4];
      neural::derivatives_of<float, A>(in.value + load_pack<float>(bias + i), 3, f);
      JetPack<Channels> out;
      out.value = f[0];
      if constexpr (Channels > 1)
        for (int k = 0; k < 3; ++k) out.first[k] = f[1] * in.first[k];
      if constexpr (Channels > 4) {
        const Pack along = in.first[0] * v[0] + in.first[1] * v[1] + in.first[2] * v[2];
        out.second = f[1] * in.second + f[2] * along * along;
      }
      store(y + begin + i, channel, out);
    }
  }
}

template <Activation A, int Channels>
SUPPLE_INLINE void backward(const JetSizes& sizes, const float* v, const float* bias, const float* z,
                            const float* grad_y, float* grad_z, float* grad_bias) {
  const std::ptrdiff_t channel = static_cast<std::ptrdiff_t>(sizes.rows) * sizes.width;
  std::fill_n(grad_bias, sizes.width, 0.0F);
  for (std::ptrdiff_t begin = 0; begin < channel; begin += sizes.width, v += 3) {
    for (int i = 0; i < sizes.width; i += pack_size) {
      JetPack<Channels> in;
      JetPack<Channels> grad;
      load(z + begin + i, channel, in);
      load(grad_y + begin + i, channel, grad);
      Pack f[4];
      neural::derivatives_of<float, A>(in.value + load_pack<float>(bias + i), 3, f);
      JetPack<Channels> out;
      out.value = f[1] * grad.value;
      if constexpr (Channels > 1) {
        Pack dot = grad.first[0] * in.first[0];
        for (int k = 1; k < 3; ++k) dot += grad.first[k] * in.first[k];
        out.value += f[2] * dot;
        for (int k = 0; k < 3; ++k) out.first[k] = f[1] * grad.first[k];
      }
      if constexpr (Channels > 4) {
        const Pack along = in.first[0] * v[0] + in.first[1] * v[1] + in.first[2] * v[2];
        out.value += grad.second * (f[2] * in.second + f[3] * along * along);
        const Pack grad_along = 2 * f[2] * along * grad.second;
        for (int k = 0; k < 3; ++k) out.first[k] += grad_along * v[k];
        out.second = f[1] * grad.second;
      }
      store(grad_z + begin + i, channel, out);
      store_pack<float>(grad_bias + i, load_pack<float>(grad_bias + i) + out.value);
    }
  }
}

template <Activation A>
SUPPLE_INLINE void forward_channels(const JetSizes& sizes, const float* v, const float* bias, const float* z,
                                    float* y) {
  switch (sizes.channels) {
    case 1:
      return forward<A, 1>(sizes, v, bias, z, y);
    case 4:
      return forward<A, 4>(sizes, v, bias, z, y);
    default:
      return forward<A, 5>(sizes, v, bias, z, y);
  }
}
template <Activation A>
SUPPLE_INLINE void backward_channels(const JetSizes& sizes, const float* v, const float* bias, const float* z,
                                     const float* grad_y, float* grad_z, float* grad_bias) {
  switch (sizes.channels) {
    case 1:
      return backward<A, 1>(sizes, v, bias, z, grad_y, grad_z, grad_bias);
    case 4:
      return backward<A, 4>(sizes, v, bias, z, grad_y, grad_z, grad_bias);
    default:
      return backward<A, 5>(sizes, v, bias, z, grad_y, grad_z, grad_bias);
  }
}

SUPPLE_INLINE void forward_all(Activation activation, const JetSizes& sizes, const float* v, const float* bias,
                               const float* z, float* y) {
  switch (activation) {
    case Activation::swish:
      return forward_channels<Activation::swish>(sizes, v, bias, z, y);
    case Activation::tanh:
      return forward_channels<Activation::tanh>(sizes, v, bias, z, y);
    case Activation::sine:
      return forward_channels<Activation::sine>(sizes, v, bias, z, y);
  }
}
SUPPLE_INLINE void backward_all(Activation activation, const JetSizes& sizes, const float* v, const float* bias,
                                const float* z, const float* grad_y, float* grad_z, float* grad_bias) {
  switch (activation) {
    case Activation::swish:
      return backward_channels<Activation::swish>(sizes, v, bias, z, grad_y, grad_z, grad_bias);
    case Activation::tanh:
      return backward_channels<Activation::tanh>(sizes, v, bias, z, grad_y, grad_z, grad_bias);
    case Activation::sine:
      return backward_channels<Activation::sine>(sizes, v, bias, z, grad_y, grad_z, grad_bias);
  }
}

SUPPLE_AVX2 void forward_avx2(Activation activation, const JetSizes& sizes, const float* v, const float* bias,
                              const float* z, float* y) {
  forward_all(activation, sizes, v, bias, z, y);
}
SUPPLE_AVX2 void backward_avx2(Activation activation, const JetSizes& sizes, const float* v, const float* bias,
                               const float* z, const float* grad_y, float* grad_z, float* grad_bias) {
  backward_all(activation, sizes, v, bias, z, grad_y, grad_z, grad_bias);
}

}  // namespace

void jet_forward(Activation activation, const JetSizes& sizes, const float* directions, const float* bias,
                 const float* z, float* y) {
  if (has_avx2)
    forward_avx2(activation, sizes, directions, bias, z, y);
  else
    forward_all(activation, sizes, directions, bias, z, y);
}

void jet_backward(Activation activation, const JetSizes& sizes, const float* directions, const float* bias,
                  const float* z, const float* grad_y, float* grad_z, float* grad_bias) {
  if (has_avx2)
    backward_avx2(activation, sizes, directions, bias, z, grad_y, grad_z, grad_bias);
  else
    backward_all(activation, sizes, directions, bias, z, grad_y, grad_z, grad_bias);
}

}  // namespace supple::training
