#pragma once

#include "supple/base/error.h"

namespace supple::design {

/// What keeps a design from being found, or a measured curve from being read. Its code begins with "design.".
class DesignFault : public Error {
 public:
  using Error::Error;
};

/// A target curve that cannot be sampled ("design.invalid_target").
class InvalidTarget : public DesignFault {
 public:
  using DesignFault::DesignFault;
};

/// A table that cannot be read, or a measurement that leaves a choice open: "design.unreadable_table" or
/// "design.invalid_measurement".
class MeasurementFault : public DesignFault {
 public:
  using DesignFault::DesignFault;
};

}  // namespace supple::design
