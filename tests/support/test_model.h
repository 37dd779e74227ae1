#pragma once

#include <cstdint>
#include <string>

#include "supple/neural/model.h"

namespace supple::test {

/// An untrained model of the family IH21 whose weights are drawn from a named stream: width 16, and small enough that
/// its energy is that of a stiffness with a gentle nonlinearity, so that equilibria near rest exist. Has errors of new
/// designs and none of new rows. The same arguments give the same model.
/// `gain` multiplies the weights of the last layer: 1e160 makes every energy but that of rest overflow.
neural::Model test_model(const std::string& id, std::uint64_t seed, double gain = 1);

}  // namespace supple::test
