#pragma once

#include <CLI/App.hpp>
#include <initializer_list>

namespace supple::cli {

/// An option that has an effect only together with something else.
struct DependentOption {
  const char* name;   ///< with its dashes; an argument without them
  bool has_effect;    ///< whether the command line has what the option acts on
  const char* where;  ///< where it has none, which ends a sentence: "without --coupon"
};

/// Throws Failure(usage) if one of the options is given and has no effect: a user who gives it expects one.
void refuse_idle_options(const CLI::App& command, std::initializer_list<DependentOption> options);

}  // namespace supple::cli
