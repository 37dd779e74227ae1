#pragma once

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
/// isohedral type N. Files are read when they are asked for first. Any thread may call.
class KeptAtlases {
 public:
  using Record = std::shared_ptr<const json::AtlasRecord>;
  using Definition = std::shared_ptr<const tiling::FamilyDefinition>;

  KeptAtlases(std::filesystem::path shipped, std::filesystem::path computed);

  /// The atlas of this name and definition; null if there is none.
  Record find(const std::string& name, const Definition& definition);
  /// Keeps an atlas. A file that cannot be written is left out: it stays in memory until the process ends.
  void keep(const std::string& name, Record record);
  /// The atlases of all families that the server has, as far as there are any.
  std::vector<Record> of_families();

 private:
  const std::filesystem::path shipped_;
  const std::filesystem::path computed_;
  std::mutex mutex_;
  std::map<std::string, Record> records_;  ///< null for a name without a file that holds
};

}  // namespace supple::routes
