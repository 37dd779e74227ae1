// Packs never leave this file's functions by value, so that their calling convention does not matter.
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
constexpr int count = neural::Packs<float>::count;

/// Channels of one pack's place.
template <int Channels>
struct Place {
  Pack value;
  Pack first[3];
  Pack second;
};

template <int Channels>
SUPPLE_INLINE void load(const float* from, std::ptrdiff_t channel, Place<Channels>& place) {
  place.value = load_pack<float>(from);
  if constexpr (Channels > 1)
    for (int i = 0; i < 3; ++i) place.first[i] = load_pack<float>(from + (1 + i) * channel);
  if constexpr (Channels > 4) place.second = load_pack<float>(from + 4 * channel);
}
template <int Channels>
SUPPLE_INLINE void store(float* to, std::ptrdiff_t channel, const Place<Channels>& place) {
  store_pack<float>(to, place.value);
  if constexpr (Channels > 1)
    for (int i = 0; i < 3; ++i) store_pack<float>(to + (1 + i) * channel, place.first[i]);
  if constexpr (Channels > 4) store_pack<float>(to + 4 * channel, place.second);
}

template <Activation A, int Channels>
SUPPLE_INLINE void forward(const JetSizes& sizes, const float* v, const float* bias, const float* z, float* y) {
  const std::ptrdiff_t channel = static_cast<std::ptrdiff_t>(sizes.rows) * sizes.width;
  for (std::ptrdiff_t begin = 0; begin < channel; begin += sizes.width, v += 3) {
    for (int i = 0; i < sizes.width; i += count) {
      Place<Channels> in;
      load(z + begin + i, channel, in);
      Pack f[4];
      neural::derivatives_of<float, A>(in.value + load_pack<float>(bias + i), 3, f);
      Place<Channels> out;
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
SUPPLE_INLINE void backward(const JetSizes& sizes, const float* v, const float* bias, const float* z, const float* g,
                            float* by_z, float* by_bias) {
  const std::ptrdiff_t channel = static_cast<std::ptrdiff_t>(sizes.rows) * sizes.width;
  std::fill_n(by_bias, sizes.width, 0.0F);
  for (std::ptrdiff_t begin = 0; begin < channel; begin += sizes.width, v += 3) {
    for (int i = 0; i < sizes.width; i += count) {
      Place<Channels> in;
      Place<Channels> by;
      load(z + begin + i, channel, in);
      load(g + begin + i, channel, by);
      Pack f[4];
      neural::derivatives_of<float, A>(in.value + load_pack<float>(bias + i), 3, f);
      Place<Channels> out;
      out.value = f[1] * by.value;
      if constexpr (Channels > 1) {
        Pack dot = by.first[0] * in.first[0];
        for (int k = 1; k < 3; ++k) dot += by.first[k] * in.first[k];
        out.value += f[2] * dot;
        for (int k = 0; k < 3; ++k) out.first[k] = f[1] * by.first[k];
      }
      if constexpr (Channels > 4) {
        const Pack along = in.first[0] * v[0] + in.first[1] * v[1] + in.first[2] * v[2];
        out.value += by.second * (f[2] * in.second + f[3] * along * along);
        const Pack by_along = 2 * f[2] * along * by.second;
        for (int k = 0; k < 3; ++k) out.first[k] += by_along * v[k];
        out.second = f[1] * by.second;
      }
      store(by_z + begin + i, channel, out);
      store_pack<float>(by_bias + i, load_pack<float>(by_bias + i) + out.value);
    }
  }
}

template <Activation A>
SUPPLE_INLINE void forward_of(const JetSizes& sizes, const float* v, const float* bias, const float* z, float* y) {
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
SUPPLE_INLINE void backward_of(const JetSizes& sizes, const float* v, const float* bias, const float* z, const float* g,
                               float* by_z, float* by_bias) {
  switch (sizes.channels) {
    case 1:
      return backward<A, 1>(sizes, v, bias, z, g, by_z, by_bias);
    case 4:
      return backward<A, 4>(sizes, v, bias, z, g, by_z, by_bias);
    default:
      return backward<A, 5>(sizes, v, bias, z, g, by_z, by_bias);
  }
}

SUPPLE_INLINE void forward_all(Activation activation, const JetSizes& sizes, const float* v, const float* bias,
                               const float* z, float* y) {
  switch (activation) {
    case Activation::swish:
      return forward_of<Activation::swish>(sizes, v, bias, z, y);
    case Activation::tanh:
      return forward_of<Activation::tanh>(sizes, v, bias, z, y);
    case Activation::sine:
      return forward_of<Activation::sine>(sizes, v, bias, z, y);
  }
}
SUPPLE_INLINE void backward_all(Activation activation, const JetSizes& sizes, const float* v, const float* bias,
                                const float* z, const float* g, float* by_z, float* by_bias) {
  switch (activation) {
    case Activation::swish:
      return backward_of<Activation::swish>(sizes, v, bias, z, g, by_z, by_bias);
    case Activation::tanh:
      return backward_of<Activation::tanh>(sizes, v, bias, z, g, by_z, by_bias);
    case Activation::sine:
      return backward_of<Activation::sine>(sizes, v, bias, z, g, by_z, by_bias);
  }
}

SUPPLE_AVX2 void forward_avx2(Activation activation, const JetSizes& sizes, const float* v, const float* bias,
                              const float* z, float* y) {
  forward_all(activation, sizes, v, bias, z, y);
}
SUPPLE_AVX2 void backward_avx2(Activation activation, const JetSizes& sizes, const float* v, const float* bias,
                               const float* z, const float* g, float* by_z, float* by_bias) {
  backward_all(activation, sizes, v, bias, z, g, by_z, by_bias);
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
                  const float* z, const float* g, float* by_z, float* by_bias) {
  if (has_avx2)
    backward_avx2(activation, sizes, directions, bias, z, g, by_z, by_bias);
  else
    backward_all(activation, sizes, directions, bias, z, g, by_z, by_bias);
}

}  // namespace supple::training
