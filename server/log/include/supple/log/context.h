#pragma once

#include <string>
#include <string_view>

namespace supple::log {

/// Says on whose behalf this thread works during the object's life, so that every line that it logs names the request
/// or the job, whichever room it comes from. Objects of one thread end in the reverse of the order in which they began.
class Context {
 public:
  /// "request", "job"; `id` has neither spaces nor line ends.
  Context(std::string_view kind, std::string_view id);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

 private:
  std::string::size_type before_;
};

/// What a line of this thread begins with: "request=00f3a1b2c4d5e6f7 ", with a space after each; the outermost context
/// comes first. Empty where there is none. It stays until the thread's next context begins or ends.
std::string_view context_text() noexcept;

}  // namespace supple::log
