#include "supple/base/error.h"

#include <utility>

namespace supple {

Error::Error(std::string code, const std::string& message, std::vector<Detail> details)
    : std::runtime_error(message), code_(std::move(code)), details_(std::move(details)) {}

}  // namespace supple
