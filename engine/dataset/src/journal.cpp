#include "supple/dataset/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>

#include "binary_codec.h"
#include "supple/base/error.h"
#include "supple/files/durable_file.h"
#include "supple/files/seal.h"

namespace supple::dataset {
namespace {

/// The first bytes of the file. The number at the end is the version of the records.
constexpr std::string_view magic = "supple data set journal 1\n";

/// The bytes of a record: the payload's length, its CRC-32, and the payload.
std::string record(const std::string& payload) {
  const auto length = static_cast<std::uint32_t>(payload.size());
  const std::uint32_t check = files::crc32(payload);
  std::string bytes(8, '\0');
  std::memcpy(bytes.data(), &length, 4);
  std::memcpy(bytes.data() + 4, &check, 4);
  return bytes + payload;
}

/// Returns the payload of the first record of `rest`, and removes the record from `rest`. Returns an empty view if the
/// record is incomplete or damaged.
std::string_view next_record(std::string_view& rest) {
  if (rest.size() < 8) return {};
  std::uint32_t length = 0;
  std::uint32_t check = 0;
  std::memcpy(&length, rest.data(), 4);
  std::memcpy(&check, rest.data() + 4, 4);
  if (rest.size() - 8 < length) return {};
  const auto payload = rest.substr(8, length);
  if (files::crc32(payload) != check) return {};
  rest.remove_prefix(8 + length);
  return payload;
}

struct Parsed {
  Journal::Content content;
  bool begun = false;            ///< whether the first record, with recipe and selection, is complete
  std::int64_t valid_bytes = 0;  ///< number of bytes up to the end of the last complete record
};

Parsed parse(std::string_view bytes, const std::filesystem::path& path) {
  Parsed parsed;
  const auto start = bytes.substr(0, magic.size());
  if (start != magic.substr(0, start.size()))
    throw Error("file.unreadable", path.string() + " is not the journal of a data set of this version.");
  if (start.size() == magic.size()) {
    auto rest = bytes.substr(magic.size());
    if (const auto first = next_record(rest); !first.empty()) {
      parsed.begun = true;
      decode(first, parsed.content.data.recipe, parsed.content.data.selection);
      for (auto payload = next_record(rest); !payload.empty(); payload = next_record(rest))
        parsed.content.data.designs.push_back(decode_design(payload));
      parsed.valid_bytes = static_cast<std::int64_t>(bytes.size() - rest.size());
    }
  }
  auto& designs = parsed.content.data.designs;
  std::sort(designs.begin(), designs.end(), [](const Design& a, const Design& b) { return a.index < b.index; });
  parsed.content.discarded_bytes = static_cast<std::int64_t>(bytes.size()) - parsed.valid_bytes;
  return parsed;
}

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  if (!file) throw Error("file.unreadable", "Cannot read " + path.string() + ".");
  return std::move(bytes).str();
}

/// Throws "dataset.different_recipe" unless a journal was begun with these settings.
void check_same(const Dataset& found, const Recipe& recipe, const Selection& selection,
                const std::filesystem::path& path) {
  std::vector<Error::Detail> details;
  for (auto& difference : differences(found.recipe, recipe)) details.push_back({"recipe", std::move(difference)});
  if (!(found.selection == selection))
    details.push_back({"selection", "the first design, the number of designs or the shard is another"});
  if (details.empty()) return;
  throw Error("dataset.different_recipe",
              path.string() + " was begun with other settings: " + details.front().message +
                  ". Go on with the same settings, or choose another output file.",
              details);
}

}  // namespace

std::filesystem::path journal_path(const std::filesystem::path& path) {
  auto journal = path;
  journal += ".partial";
  return journal;
}

Journal::Content Journal::read(const std::filesystem::path& journal) {
  Parsed parsed = parse(content_of(journal), journal);
  if (!parsed.begun) throw Error("file.unreadable", journal.string() + " holds nothing yet.");
  return std::move(parsed.content);
}

Journal::Journal(const std::filesystem::path& journal, const Recipe& recipe, const Selection& selection)
    : path_(journal), descriptor_(::open(journal.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644)) {
  if (descriptor_ < 0) files::throw_write_failed("open", journal);
  try {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0)
      throw Error("dataset.in_use", "Another process is writing " + journal.string() + ".");
    Parsed parsed = parse(content_of(journal), journal);
    if (parsed.begun) check_same(parsed.content.data, recipe, selection, journal);
    if (parsed.content.discarded_bytes > 0 && ::ftruncate(descriptor_, parsed.valid_bytes) != 0)
      files::throw_write_failed("truncate", journal);
    if (!parsed.begun) {
      files::append_durably(descriptor_, std::string(magic) + record(encode(recipe, selection)), journal);
      files::synchronize_folder_of(journal);
      parsed.content.data.recipe = recipe;
      parsed.content.data.selection = selection;
    }
    content_ = std::move(parsed.content);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

Journal::~Journal() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Journal::append(const Design& design) { files::append_durably(descriptor_, record(encode(design)), path_); }

void Journal::remove() {
  if (::unlink(path_.c_str()) != 0) files::throw_write_failed("remove", path_);
  files::synchronize_folder_of(path_);
}

}  // namespace supple::dataset
