#include "supple/files/durable_file.h"

#include <fcntl.h>

#include <cerrno>
#include <cstdio>

#include "supple/base/durable_file.h"
#include "supple/base/error.h"

namespace supple::files {
namespace {

[[noreturn]] void throw_write_failed(const FileError& error) {
  throw Error("file.write_failed",
              "Cannot " + error.action() + " " + error.path().string() + ": " + error.reason() + ".");
}

}  // namespace

void throw_write_failed(const std::string& action, const std::filesystem::path& path) {
  throw_write_failed(FileError(action, path, errno));
}

void append_durably(int descriptor, std::string_view bytes, const std::filesystem::path& path) {
  try {
    write_all(descriptor, bytes, path);
    synchronize(descriptor, path);
  } catch (const FileError& error) {
    throw_write_failed(error);
  }
}

void synchronize_folder_of(const std::filesystem::path& path) {
  try {
    supple::synchronize_folder_of(path);
  } catch (const FileError& error) {
    throw_write_failed(error);
  }
}

void move_into_place(const std::filesystem::path& finished, const std::filesystem::path& place) {
  try {
    const OpenFile file(finished, O_RDONLY, "open");
    synchronize(file.descriptor(), finished);
    if (std::rename(finished.c_str(), place.c_str()) != 0) throw FileError("rename", finished, errno);
    supple::synchronize_folder_of(place);
  } catch (const FileError& error) {
    throw_write_failed(error);
  }
}

}  // namespace supple::files
