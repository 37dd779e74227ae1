// Only inlined functions pass vectors of four doubles by value here, so that their calling convention does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"
#include "elastic_kernel.h"

#include <cmath>
#include <limits>

namespace supple::microscale {
namespace {

/// Integration points in barycentric coordinates, of equal weight: exact for quadratic polynomials.
constexpr int points = 3;
constexpr double point[points][3] = {
    {2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}, {1.0 / 6, 1.0 / 6, 2.0 / 3}};

/// Gradients of the six shape functions at an integration point: L (2 L - 1) at corners, 4 L L' at midpoints.
SUPPLE_INLINE void shape_gradients(const Lanes (&corner)[3][2], int q, Lanes (&gradient)[6][2]) {
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      gradient[k][i] = (4 * point[q][k] - 1) * corner[k][i];
      gradient[3 + k][i] = 4 * (point[q][k] * corner[next][i] + point[q][next] * corner[k][i]);
    }
  }
}

/// F - I at an integration point.
SUPPLE_INLINE void displacement_gradient(const ElasticBatch& batch, const Lanes (&gradient)[6][2], Lanes (&h)[2][2]) {
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      h[i][j] = batch.strain_change[i][j];
      for (int k = 0; k < 6; ++k) h[i][j] += batch.displacement[k][i] * gradient[k][j];
    }
  }
}

/// Adds the contribution of one integration point at which F - I is `h`. Returns false if det F <= 0 there.
SUPPLE_INLINE bool add_point(const MaterialLaw& law, int order, const Lanes (&h)[2][2], const Lanes (&shape)[6][2],
                             const Lanes& weight, ElasticBatch& batch) {
  const Lanes trace = h[0][0] + h[1][1];
  const Lanes square = h[0][0] * h[0][0] + h[0][1] * h[0][1] + h[1][0] * h[1][0] + h[1][1] * h[1][1];
  const Lanes j_minus_one = trace + h[0][0] * h[1][1] - h[0][1] * h[1][0];
  for (int lane = 0; lane < lanes; ++lane)
    if (!(j_minus_one[lane] > -1)) return false;

  // psi, a = J g' and b = J (J g')', see MaterialLaw. They are written in F - I, so that small strains lose no digits.
  Lanes psi;
  Lanes a;
  Lanes b;
  const Lanes j = 1 + j_minus_one;
  if (law.law == Law::neo_hookean) {
    Lanes log_j = constant_lanes(0);
    for (int lane = 0; lane < lanes; ++lane) log_j[lane] = std::log1p(j_minus_one[lane]);
    psi = law.mu * (trace + 0.5 * square - log_j) + 0.5 * law.lambda * log_j * log_j;
    a = law.lambda * log_j - law.mu;
    b = constant_lanes(law.lambda);
  } else {
    const Lanes inverse_square = 1 / (j * j);
    psi = 0.5 * law.mu * (2 * trace + square - j_minus_one * (2 + j_minus_one) * inverse_square);
    a = -law.mu * inverse_square;
    b = 2 * law.mu * inverse_square;
  }
  batch.energy += weight * psi;
  if (order < 1) return true;

  const Lanes f[2][2] = {{1 + h[0][0], h[0][1]}, {h[1][0], 1 + h[1][1]}};
  const Lanes inverse = 1 / j;
  const Lanes inverse_transpose[2][2] = {{f[1][1] * inverse, -f[1][0] * inverse},
                                         {-f[0][1] * inverse, f[0][0] * inverse}};
  // Gradients of the shape functions at rest and, multiplied by F^-T, in the deformed state.
  Lanes at_rest[local_nodes][2];
  Lanes deformed[local_nodes][2];
  for (int k = 0; k < 6; ++k)
    for (int i = 0; i < 2; ++i) at_rest[k][i] = shape[k][i];
  for (int column = 0; column < 2; ++column)
    for (int i = 0; i < 2; ++i) at_rest[6 + column][i] = constant_lanes(i == column ? 1 : 0);
  for (int k = 0; k < local_nodes; ++k)
    for (int i = 0; i < 2; ++i)
      deformed[k][i] = inverse_transpose[i][0] * at_rest[k][0] + inverse_transpose[i][1] * at_rest[k][1];

  // The first Piola-Kirchhoff stress mu F + a F^-T, written so that large numbers do not cancel near rest.
  Lanes stress[2][2];
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 2; ++k)
      stress[i][k] = law.mu * (f[i][k] - inverse_transpose[i][k]) + (a + law.mu) * inverse_transpose[i][k];
  for (int k = 0; k < local_nodes; ++k)
    for (int i = 0; i < 2; ++i)
      batch.force[k][i] += weight * (stress[i][0] * at_rest[k][0] + stress[i][1] * at_rest[k][1]);
  if (order < 2) return true;

  const Lanes weighted_mu = weight * law.mu;
  const Lanes weighted_a = weight * a;
  const Lanes weighted_b = weight * b;
  for (int k = 0, pair = 0; k < local_nodes; ++k) {
    for (int l = 0; l <= k; ++l, ++pair) {
      const Lanes product = weighted_mu * (at_rest[k][0] * at_rest[l][0] + at_rest[k][1] * at_rest[l][1]);
      for (int i = 0; i < 2; ++i)
        for (int m = 0; m < 2; ++m)
          batch.stiffness[pair][i][m] +=
              weighted_b * deformed[k][i] * deformed[l][m] - weighted_a * deformed[l][i] * deformed[k][m];
      batch.stiffness[pair][0][0] += product;
      batch.stiffness[pair][1][1] += product;
    }
  }
  return true;
}

SUPPLE_INLINE bool integrate_batch(const MaterialLaw& law, int order, ElasticBatch& batch) {
  const Lanes zero = constant_lanes(0);
  batch.energy = zero;
  if (order >= 1)
    for (auto& node : batch.force) node[0] = node[1] = zero;
  if (order >= 2)
    for (auto& pair : batch.stiffness)
      for (auto& row : pair) row[0] = row[1] = zero;
  const Lanes weight = batch.area / points;
  for (int q = 0; q < points; ++q) {
    Lanes gradient[6][2];
    Lanes h[2][2];
    shape_gradients(batch.barycentric_gradient, q, gradient);
    displacement_gradient(batch, gradient, h);
    if (!add_point(law, order, h, gradient, weight, batch)) return false;
  }
  return true;
}

/// The least positive root of c + b t + a t^2, c > 0; infinity if there is none.
double first_root(double a, double b, double c) {
  const double none = std::numeric_limits<double>::infinity();
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return none;
  // q has the sign of -b, so that nothing cancels. The roots are q / a and c / q.
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  double first = none;
  if (q != 0 && c / q > 0) first = c / q;
  if (a != 0 && q / a > 0) first = std::fmin(first, q / a);
  return first;
}

SUPPLE_INLINE double first_inversion_of_batch(const ElasticBatch& at, const ElasticBatch& along) {
  double first = std::numeric_limits<double>::infinity();
  for (int q = 0; q < points; ++q) {
    Lanes gradient[6][2];
    Lanes h[2][2];
    Lanes d[2][2];
    shape_gradients(at.barycentric_gradient, q, gradient);
    displacement_gradient(at, gradient, h);
    displacement_gradient(along, gradient, d);
    // det (F + t D) = det F + t (F : cof D) + t^2 det D.
    const Lanes c = (1 + h[0][0]) * (1 + h[1][1]) - h[0][1] * h[1][0];
    const Lanes b = (1 + h[0][0]) * d[1][1] + (1 + h[1][1]) * d[0][0] - h[0][1] * d[1][0] - h[1][0] * d[0][1];
    const Lanes a = d[0][0] * d[1][1] - d[0][1] * d[1][0];
    for (int lane = 0; lane < lanes; ++lane) {
      // Most triangles are far from inversion: |b| t + |a| t^2 is less than c up to the limit of t.
      const double max_step = max_inversion_step;
      if (c[lane] > max_step * (std::abs(b[lane]) + max_step * std::abs(a[lane]))) continue;
      first = std::fmin(first, first_root(a[lane], b[lane], c[lane]));
    }
  }
  return first;
}

bool integrate_portable(const MaterialLaw& law, int order, ElasticBatch& batch) {
  return integrate_batch(law, order, batch);
}

SUPPLE_AVX2 bool integrate_avx2(const MaterialLaw& law, int order, ElasticBatch& batch) {
  return integrate_batch(law, order, batch);
}

SUPPLE_AVX2 double first_inversion_avx2(const ElasticBatch& at, const ElasticBatch& along) {
  return first_inversion_of_batch(at, along);
}

}  // namespace

bool integrate(const MaterialLaw& law, int order, ElasticBatch& batch) {
  if (has_avx2) return integrate_avx2(law, order, batch);
  return integrate_portable(law, order, batch);
}

double first_inversion(const ElasticBatch& at, const ElasticBatch& along) {
  if (has_avx2) return first_inversion_avx2(at, along);
  return first_inversion_of_batch(at, along);
}

}  // namespace supple::microscale
