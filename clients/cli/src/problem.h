#pragma once

#include <string>

#include "failure.h"

namespace supple::cli {

/// The failure that a 4xx or 5xx answer stands for. A problem+json body gives the sentence, its code and a line for
/// each field at fault; any other body is quoted shortened.
Failure problem_failure(int status, const std::string& body);

}  // namespace supple::cli
