#pragma once

#include <cstdint>
#include <string>

#include "supple/neural/model.h"

namespace supple::test {

/// An untrained model of the family IH21 of width 16, with random weights from a named stream. The weights are so small
/// that its energy is slightly nonlinear, so that equilibria near rest exist. It has errors for new designs, and none
/// for new rows. The same arguments give the same model. `gain` multiplies the weights of the last layer: with 1e160
/// every energy overflows except that at rest.
neural::Model test_model(const std::string& id, std::uint64_t seed, double gain = 1);

}  // namespace supple::test
