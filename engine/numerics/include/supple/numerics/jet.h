#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "supple/base/lanes.h"

/// Not forced inline in builds with sanitizers: functions with hundreds of inlined operations would take minutes to
/// compile.
#ifdef SUPPLE_SANITIZED
#define SUPPLE_JET_INLINE inline
#else
#define SUPPLE_JET_INLINE SUPPLE_INLINE
#endif

namespace supple::numerics {

/// A number with its first and second derivatives with respect to n variables: forward-mode differentiation, exact to
/// rounding. The second derivatives are stored as a lower triangle, row by row. An operation costs about 2 n^2
/// multiply-adds.
template <int n>
struct Jet {
  static constexpr int variables = n;
  static constexpr int pairs = n * (n + 1) / 2;
  double value = 0;
  std::array<double, n> first{};
  std::array<double, pairs> second{};

  Jet() = default;
  Jet(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor): a constant is a jet
  static Jet variable(double at, int index) {
    Jet jet(at);
    jet.first[index] = 1;
    return jet;
  }
  double hessian(int i, int j) const { return second[i > j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i]; }
};

/// f(a) for a function with value f, first derivative d and second derivative dd at a.
template <int n>
SUPPLE_JET_INLINE Jet<n> compose(const Jet<n>& a, double f, double d, double dd) {
  Jet<n> r(f);
  for (int i = 0; i < n; ++i) r.first[i] = d * a.first[i];
  int k = 0;
  for (int i = 0; i < n; ++i) {
    const double scaled = dd * a.first[i];
    for (int j = 0; j <= i; ++j, ++k) r.second[k] = d * a.second[k] + scaled * a.first[j];
  }
  return r;
}

template <int n>
SUPPLE_JET_INLINE Jet<n> operator*(const Jet<n>& a, const Jet<n>& b) {
  Jet<n> r(a.value * b.value);
  for (int i = 0; i < n; ++i) r.first[i] = a.value * b.first[i] + b.value * a.first[i];
  int k = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j, ++k)
      r.second[k] = a.value * b.second[k] + b.value * a.second[k] + (a.first[i] * b.first[j] + b.first[i] * a.first[j]);
  return r;
}
template <int n>
SUPPLE_JET_INLINE Jet<n> operator*(double a, Jet<n> b) {
  b.value *= a;
  for (double& x : b.first) x *= a;
  for (double& x : b.second) x *= a;
  return b;
}
template <int n>
SUPPLE_JET_INLINE Jet<n> operator*(const Jet<n>& a, double b) {
  return b * a;
}
template <int n>
SUPPLE_JET_INLINE Jet<n> operator+(Jet<n> a, const Jet<n>& b) {
  a.value += b.value;
  for (int i = 0; i < n; ++i) a.first[i] += b.first[i];
  for (int i = 0; i < Jet<n>::pairs; ++i) a.second[i] += b.second[i];
  return a;
}
template <int n>
SUPPLE_JET_INLINE Jet<n> operator-(Jet<n> a, const Jet<n>& b) {
  a.value -= b.value;
  for (int i = 0; i < n; ++i) a.first[i] -= b.first[i];
  for (int i = 0; i < Jet<n>::pairs; ++i) a.second[i] -= b.second[i];
  return a;
}
template <int n>
SUPPLE_JET_INLINE Jet<n> operator-(const Jet<n>& a) {
  return -1.0 * a;
}
template <int n>
SUPPLE_JET_INLINE Jet<n> operator+(Jet<n> a, double b) {
  a.value += b;
  return a;
}
template <int n>
SUPPLE_JET_INLINE Jet<n> operator+(double a, Jet<n> b) {
  b.value += a;
  return b;
}
template <int n>
SUPPLE_JET_INLINE Jet<n> operator-(double a, const Jet<n>& b) {
  return a + -b;
}
template <int n>
SUPPLE_JET_INLINE Jet<n> inverse(const Jet<n>& a) {
  const double f = 1 / a.value;
  return compose(a, f, -f * f, 2 * f * f * f);
}
SUPPLE_JET_INLINE double inverse(double a) { return 1 / a; }

template <int n>
SUPPLE_JET_INLINE Jet<n> sqrt(const Jet<n>& a) {
  const double f = std::sqrt(a.value);
  return compose(a, f, 0.5 / f, -0.25 / (f * a.value));
}
template <int n>
SUPPLE_JET_INLINE Jet<n> sin(const Jet<n>& a) {
  const double s = std::sin(a.value);
  return compose(a, s, std::cos(a.value), -s);
}
template <int n>
SUPPLE_JET_INLINE Jet<n> cos(const Jet<n>& a) {
  const double c = std::cos(a.value);
  return compose(a, c, -std::sin(a.value), -c);
}
/// The angle of the vector (x, y).
template <int n>
SUPPLE_JET_INLINE Jet<n> atan2(const Jet<n>& y, const Jet<n>& x) {
  const double r2 = x.value * x.value + y.value * y.value;
  const double fx = -y.value / r2;
  const double fy = x.value / r2;
  const double fxy = (y.value * y.value - x.value * x.value) / (r2 * r2);
  const double fxx = 2 * x.value * y.value / (r2 * r2);
  Jet<n> r(std::atan2(y.value, x.value));
  for (int i = 0; i < n; ++i) r.first[i] = fx * x.first[i] + fy * y.first[i];
  int k = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j, ++k)
      r.second[k] = fx * x.second[k] + fy * y.second[k] + fxx * (x.first[i] * x.first[j] - y.first[i] * y.first[j]) +
                    fxy * (x.first[i] * y.first[j] + y.first[i] * x.first[j]);
  return r;
}

/// Vectors of numbers or jets. They replace Eigen's vectors, whose expressions copy jets.
template <typename T>
struct Vector3 {
  T x, y, z;
};

template <typename T, typename S>
SUPPLE_JET_INLINE T dot(const Vector3<T>& a, const Vector3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T, typename S>
SUPPLE_JET_INLINE Vector3<T> cross(const Vector3<T>& a, const Vector3<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename T>
SUPPLE_JET_INLINE Vector3<T> operator+(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename T>
SUPPLE_JET_INLINE Vector3<T> operator-(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename T>
SUPPLE_JET_INLINE Vector3<T> operator*(const T& a, const Vector3<T>& b) {
  return {a * b.x, a * b.y, a * b.z};
}
template <typename T>
SUPPLE_JET_INLINE T norm(const Vector3<T>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

}  // namespace supple::numerics
