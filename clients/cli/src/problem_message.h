#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "problem.h"

namespace supple::cli {

/// What a field of a request is called on the command line: "--strain", "points 'v9'" or, of a request that comes from
/// a file, "the field accuracy.tolerance". `pointer` is a JSON pointer (RFC 6901) into the request.
std::string name_of_field(const std::string& pointer, const std::vector<const CLI::App*>& commands);

/// What a user is told of a problem: the server's sentence, a line for each fault by the option that it belongs to, and
/// what to do next.
std::string problem_message(const Problem& problem, const CLI::App& program);

}  // namespace supple::cli
