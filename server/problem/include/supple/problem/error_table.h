#pragma once

#include <span>
#include <string_view>

namespace supple::problem {

/// One row of api/errors.yaml.
struct ErrorKind {
  std::string_view code;   ///< stable identifier, "mesh.non_manifold_edge"
  int status;              ///< HTTP status
  std::string_view title;  ///< what kind of error it is
  std::string_view hint;   ///< what to do next
};

/// All rows, in the order of the file.
std::span<const ErrorKind> error_table();

/// The row of a code, or that of "server.internal" for a code that the table lacks. O(rows).
const ErrorKind& error_kind(std::string_view code);

}  // namespace supple::problem
