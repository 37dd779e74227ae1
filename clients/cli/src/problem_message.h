#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "problem.h"

namespace supple::cli {

/// The name on the command line for a field of a request: "--strain", "points 'v9'", or "the field accuracy.tolerance"
/// if the request comes from a file. `pointer` is a JSON pointer (RFC 6901) into the request.
std::string name_of_field(const std::string& pointer, const std::vector<const CLI::App*>& commands);

/// The message to the user about a problem: the server's sentence, a line for each fault with the option that it
/// belongs to, and what to do next.
std::string problem_message(const Problem& problem, const CLI::App& program);

}  // namespace supple::cli
