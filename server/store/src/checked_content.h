#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "supple/base/cancellation.h"
#include "supple/store/open_content.h"

namespace supple::store {

/// Opens a stored file and compares its body with a hash, piece by piece: O(its bytes) in time, a mebibyte of memory.
/// `kind` is that of a RecordFile, whose body follows its lines; where it is empty, or the file is none of that kind,
/// all of the file is its body. Throws "store.corrupted", "store.unavailable", and what a requested stop does.
OpenContent open_checked(const std::filesystem::path& path, std::string_view kind, const std::string& hash,
                         const CancellationToken& cancellation);

}  // namespace supple::store
