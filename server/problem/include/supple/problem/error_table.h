#pragma once

#include <span>
#include <string_view>

namespace supple::problem {

/// One row of api/errors.yaml.
struct ErrorKind {
  std::string_view code;   ///< stable identifier, for example "mesh.non_manifold_edge"
  int status;              ///< HTTP status
  std::string_view title;  ///< short description of the kind of error
  std::string_view hint;   ///< advice to the client
};

/// All rows, in the order of the file.
std::span<const ErrorKind> error_table();

/// The row of a code; the row of "server.internal" if the table lacks the code. O(rows).
const ErrorKind& error_kind(std::string_view code);

}  // namespace supple::problem
