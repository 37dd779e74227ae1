#include "checked_content.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "file_access.h"
#include "hasher.h"
#include "record_file.h"

namespace supple::store {
namespace {

constexpr std::uint64_t piece = 1 << 20;  // bytes

/// Offset of the body of a file. The header is short unless a client gave it long texts.
std::uint64_t body_begin(const OpenContent& all, std::string_view kind, const std::string& name) {
  constexpr std::uint64_t usual_header_bytes = 16 << 10;
  for (std::uint64_t size = usual_header_bytes;; size *= 8) {
    std::string begin(std::min(size, all.size()), '\0');
    all.read(0, begin.data(), begin.size());
    if (!RecordFile::starts_with_header(kind, begin)) return 0;
    if (begin.find("\n\n") != std::string::npos || begin.size() == all.size())
      return RecordFile::parse(kind, begin, name).header_size();
  }
}

}  // namespace

void OpenContent::read(std::uint64_t offset, char* to, std::size_t count) const {
  while (count > 0) {
    const auto got = ::pread(file_->descriptor(), to, count, static_cast<off_t>(begin_ + offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw_file_error("read", name_, errno);
    if (got == 0) throw_corrupted(name_);
    to += got;
    offset += static_cast<std::uint64_t>(got);
    count -= static_cast<std::size_t>(got);
  }
}

std::string OpenContent::text() const {
  std::string text(size_, '\0');
  read(0, text.data(), text.size());
  return text;
}

OpenContent open_checked(const std::filesystem::path& path, std::string_view kind, const std::string& hash,
                         const CancellationToken& cancellation) {
  const auto name = path.filename().string();
  std::shared_ptr<const OpenFile> file;
  struct stat status {};
  try {
    file = std::make_shared<const OpenFile>(path, O_RDONLY, "open");
    if (::fstat(file->descriptor(), &status) != 0) throw FileError("read", path, errno);
  } catch (const FileError& error) {
    if (error.number() == ENOENT) throw_missing(name);
    throw_file_error(error.action(), error.path(), error.number());
  }
  const OpenContent all(file, name, 0, static_cast<std::uint64_t>(status.st_size));
  const auto begin = kind.empty() ? 0 : body_begin(all, kind, name);
  OpenContent body(file, name, begin, all.size() - begin);
  Hasher hasher;
  std::string buffer(std::min(piece, body.size()), '\0');
  for (std::uint64_t at = 0; at < body.size(); at += piece) {
    cancellation.throw_if_requested();
    const auto count = std::min(piece, body.size() - at);
    body.read(at, buffer.data(), count);
    hasher.add(std::string_view(buffer).substr(0, count));
  }
  if (hasher.hexadecimal() != hash) throw_corrupted(name);
  return body;
}

}  // namespace supple::store
