#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "supple/json/family_atlases.h"

namespace supple::routes {

/// The atlases that are answered without a computation: files "NAME.json" of the data folder's folder "atlases", which
/// were computed here, and of the folder with the shipped ones. The names are ids of families, and "type-N" for the
/// isohedral type N. Files are read when they are asked for first.
///
/// Atlases of families that clients have added are files of the folder "added" in the first one. They have the hash of
/// the definition as their name and are found by it alone: two clients may have families of one id. They are read
/// whenever they are asked for, and the oldest ones make room for new ones.
///
/// Any thread may call.
class KeptAtlases {
 public:
  using Record = std::shared_ptr<const json::AtlasRecord>;
  using Definition = std::shared_ptr<const tiling::FamilyDefinition>;

  /// Atlases of added families that are kept; each has a tenth of a megabyte.
  static constexpr std::size_t max_added = 256;

  KeptAtlases(std::filesystem::path shipped, std::filesystem::path computed);

  /// The atlas of this name and definition; null if there is none.
  Record find(const std::string& name, const Definition& definition);
  /// Keeps an atlas. A file that cannot be written is left out: it stays in memory until the process ends.
  void keep(const std::string& name, Record record);
  /// The atlas of an added family with this definition; null if there is none.
  Record find_added(const Definition& definition) const;
  /// Keeps the atlas of an added family, unless its file cannot be written.
  void keep_added(const json::AtlasRecord& record);
  /// The atlases of the families that come with the server, as far as there are any.
  std::vector<Record> of_families();

 private:
  const std::filesystem::path shipped_;
  const std::filesystem::path computed_;
  const std::filesystem::path added_;
  std::mutex mutex_;
  std::map<std::string, Record> records_;  ///< null for a name without a file that holds
};

}  // namespace supple::routes
