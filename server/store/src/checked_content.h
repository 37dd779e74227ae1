#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "supple/base/cancellation.h"
#include "supple/store/open_content.h"

namespace supple::store {

/// Opens a stored file and compares its body with a hash, piece by piece: O(its bytes) in time, a mebibyte of memory.
/// In a RecordFile of this `kind`, the body follows the header; any other file is all body. Throws "store.corrupted",
/// "store.unavailable", and the error of a stop request.
OpenContent open_checked(const std::filesystem::path& path, std::string_view kind, const std::string& hash,
                         const CancellationToken& cancellation);

}  // namespace supple::store
