#pragma once

#include "supple/neural/calibration.h"

namespace supple::test {

/// A calibration of a network with this number of parameters. Its error bars, one for each of neural::all_quantities,
/// are constant: 2 % of a stress, 4 % of a stiffness, 0.06 for a Poisson's ratio, 8 % of a stress at a given strain.
neural::Calibration test_calibration(int parameters);

}  // namespace supple::test
