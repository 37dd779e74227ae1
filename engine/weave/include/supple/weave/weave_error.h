#pragma once

#include "supple/base/error.h"

namespace supple::weave {

/// A weave, a load or an option that this room refuses. Its code begins with "weave.".
class WeaveError : public Error {
 public:
  using Error::Error;
};

/// An option or a value of a printer's profile is out of its range ("weave.invalid_option").
class InvalidOption : public WeaveError {
 public:
  using WeaveError::WeaveError;
};

/// A load that cannot be applied to the weave ("weave.invalid_load").
class InvalidLoad : public WeaveError {
 public:
  using WeaveError::WeaveError;
};

/// A weave that cannot be printed as it lies ("weave.not_printable").
class NotPrintable : public WeaveError {
 public:
  using WeaveError::WeaveError;
};

}  // namespace supple::weave
