#pragma once

#include <string>

namespace supple {

/// Makes spdlog write to standard error. A line consists of the time, the level ("info"), the request or job that it
/// concerns (log::Context), and the text. `level` is the name of a level of spdlog; lower levels are not logged.
void start_log(const std::string& level);

}  // namespace supple
