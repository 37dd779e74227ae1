#include "support/test_calibration.h"

#include <cmath>

#include "supple/neural/error_features.h"

namespace supple::test {

neural::Calibration test_calibration(int parameters) {
  neural::Calibration calibration;
  double bar = 0;
  for (const auto quantity : neural::all_quantities) {
    auto& scale = calibration.scales[static_cast<std::size_t>(quantity)];
    const auto features = quantity == neural::Quantity::stress_at_strain ? neural::strain_feature_count(parameters)
                                                                         : neural::uniaxial_feature_count(parameters);
    scale.least.setConstant(features, -100);
    scale.greatest.setConstant(features, 100);
    scale.mean.setZero(features);
    scale.deviation.setOnes(features);
    scale.coefficients.setZero(1 + features + features * (features + 1) / 2);
    scale.given.knots = {0};
    scale.given.offsets = {std::log((bar += 0.02) + calibration.floor)};
    scale.given.judged = {12, 480, 0.91, bar, {bar, bar}, {0.9, 0.92}, 40, 39, 10, 440, 438, 400};
  }
  return calibration;
}

}  // namespace supple::test
