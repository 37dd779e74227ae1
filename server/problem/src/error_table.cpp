#include "supple/problem/error_table.h"

#include <algorithm>
#include <array>

namespace supple::problem {
namespace {

constexpr auto table = std::to_array<ErrorKind>({
#include "error_table_rows.inc"
});

constexpr const ErrorKind* find(std::string_view code) {
  return std::find_if(table.begin(), table.end(), [code](const ErrorKind& kind) { return kind.code == code; });
}

static_assert(find("server.internal") != table.end());

}  // namespace

std::span<const ErrorKind> error_table() { return table; }

const ErrorKind& error_kind(std::string_view code) {
  const auto* row = find(code);
  return row == table.end() ? *find("server.internal") : *row;
}

}  // namespace supple::problem
