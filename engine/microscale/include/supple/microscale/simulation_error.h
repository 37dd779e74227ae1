#pragma once

#include "supple/base/error.h"

namespace supple::microscale {

/// A load or an option that a simulation refuses. Its code begins with "simulation.".
class SimulationError : public Error {
 public:
  using Error::Error;
};

/// A load that no cell can be given ("simulation.invalid_load").
class InvalidLoad : public SimulationError {
 public:
  using SimulationError::SimulationError;
};

}  // namespace supple::microscale
