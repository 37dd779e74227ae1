#pragma once

#include <string>
#include <string_view>

namespace supple::log {

/// During the lifetime of a Context, every line that this thread logs names the request or the job for which the thread
/// works, whichever room logs it. The contexts of a thread are destroyed in the reverse order of their construction.
class Context {
 public:
  /// `kind` is "request" or "job". `id` contains neither spaces nor line ends.
  Context(std::string_view kind, std::string_view id);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

 private:
  std::string::size_type before_;
};

/// The beginning of this thread's log lines: "request=00f3a1b2c4d5e6f7 ". The outermost context comes first, and a
/// space follows each one. Empty if there is no context. The text is valid until a context of this thread is
/// constructed or destroyed.
std::string_view context_text() noexcept;

}  // namespace supple::log
