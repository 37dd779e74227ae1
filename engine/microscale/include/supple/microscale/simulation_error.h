#pragma once

#include "supple/base/error.h"

namespace supple::microscale {

/// A load or an option that a simulation refuses. Its code begins with "simulation.".
class SimulationError : public Error {
 public:
  using Error::Error;
};

}  // namespace supple::microscale
