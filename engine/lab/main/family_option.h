#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <string>

#include "supple/lab/dataset_options.h"

namespace supple::lab {

/// The family that a command line means.
struct FamilyOption {
  std::string family;                ///< id of a shipped one
  std::filesystem::path definition;  ///< file of a family of one's own; empty for a shipped family
};

/// Adds --family and --definition.
void add_family_options(CLI::App& command, FamilyOption& option);

/// Sets the family of a data set. Throws "dataset.invalid_option" unless there is one of the two, "file.unreadable" for
/// a file without a definition, and "family.faulty" for tiles that do not fill the plane.
void set_family(const FamilyOption& option, DatasetOptions& options);

}  // namespace supple::lab
