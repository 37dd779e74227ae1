#include "supple/log/context.h"

namespace supple::log {
namespace {

thread_local std::string text;

}  // namespace

Context::Context(std::string_view kind, std::string_view id) : before_(text.size()) {
  text.append(kind).append("=").append(id).append(" ");
}

Context::~Context() { text.resize(before_); }

std::string_view context_text() noexcept { return text; }

}  // namespace supple::log
