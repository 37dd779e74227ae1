#pragma once

#include <cmath>

#include "supple/neural/network.h"
#include "supple/neural/packs.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace supple::neural {

/// Sets f[0] to the activation at z, and f[1], f[2], f[3] to its derivatives. Derivatives of an order above
/// `derivatives` may be left out.
template <class Real, Activation A>
SUPPLE_INLINE void derivatives_of(const Pack<Real>& z, int derivatives, Pack<Real> (&f)[4]) {
  if constexpr (A == Activation::swish) {
    const Pack<Real> s = 1 / (1 + exponential<Real>(-z));
    const Pack<Real> q = s * (1 - s);
    const Pack<Real> h = 1 - 2 * s;
    f[0] = z * s;
    f[1] = s + z * q;
    if (derivatives > 1) f[2] = q * (2 + z * h);
    if (derivatives > 2) f[3] = q * (3 * h + z * (h * h - 2 * q));
  } else if constexpr (A == Activation::tanh) {
    const Pack<Real> t = 1 - 2 / (exponential<Real>(2 * z) + 1);
    f[0] = t;
    f[1] = 1 - t * t;
    f[2] = -2 * t * f[1];
    f[3] = -2 * (f[1] * f[1] + t * f[2]);
  } else {
    for (int lane = 0; lane < Packs<Real>::count; ++lane) {
      f[0][lane] = std::sin(z[lane]);
      f[1][lane] = std::cos(z[lane]);
    }
    f[2] = -f[0];
    f[3] = -f[1];
  }
}

}  // namespace supple::neural

#pragma GCC diagnostic pop
