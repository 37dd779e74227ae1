#pragma once

#include <string>

namespace supple {

/// From here on spdlog writes to standard error: the time, the level ("info"), the request or the job that the line is
/// about (log::Context), the text. `level` is a name that spdlog knows.
void start_log(const std::string& level);

}  // namespace supple
