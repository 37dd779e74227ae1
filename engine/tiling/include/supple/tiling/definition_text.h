#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "supple/tiling/family_definition.h"

namespace supple::tiling {

/// A definition as text, for the files of data sets and models: one line for each part, each of them a word followed by
/// values. Numbers have as many digits as it takes to read the same ones. The tile of an isohedral type is not written.
std::string to_text(const FamilyDefinition& definition);

/// The definition that `to_text` has written, equal in every bit. Throws "file.unreadable", which names the line, for a
/// text that is none, and for a definition with fields out of range. Takes some tens of microseconds.
FamilyDefinition definition_of_text(std::string_view text);

/// The family that a file means: that of the definition, or where it has none the shipped one with this id. Throws
/// "file.unreadable" for a definition with another id, and what `definition_of_text` and `family` throw.
std::shared_ptr<const Family> family_of(const std::string& id, std::string_view definition_text);

}  // namespace supple::tiling
