#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace supple {

/// A mistake in what the caller asked for, or a computation that could not be finished.
///
/// `code` is a stable, dotted identifier ("mesh.non_manifold"); every code that the engine throws is a row of
/// api/errors.yaml, and a test compares the two. `what()` is one sentence for a person. Each detail names the field or
/// the mesh element at fault and, where a limit is exceeded, the limit and the value.
class Error : public std::runtime_error {
 public:
  /// A quantity of which there is too little.
  struct Shortage {
    double needed = 0;
    double available = 0;
  };
  struct Detail {
    std::string where;    ///< path of the offending input, e.g. "points/3/barycentric" or "face 17"
    std::string message;  ///< what is wrong with it
    /// The two numbers of the message, in its unit, if more of a quantity would mend it.
    std::optional<Shortage> shortage{};
  };

  Error(std::string code, const std::string& message, std::vector<Detail> details = {});

  const std::string& code() const noexcept { return code_; }
  const std::vector<Detail>& details() const noexcept { return details_; }

 private:
  std::string code_;
  std::vector<Detail> details_;
};

}  // namespace supple
