#include "server_log.h"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "supple/log/context.h"

namespace supple {
namespace {

/// Inserts the context of the thread. A line is formatted on the thread that logs it.
class ContextFlag final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg&, const std::tm&, spdlog::memory_buf_t& target) override {
    const auto text = log::context_text();
    target.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<ContextFlag>(); }
};

}  // namespace

void start_log(const std::string& level) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("supple-server"));
  spdlog::set_level(spdlog::level::from_str(level));
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<ContextFlag>('*').set_pattern("%Y-%m-%dT%H:%M:%S.%e%z %l %*%v");
  spdlog::set_formatter(std::move(formatter));
}

}  // namespace supple
