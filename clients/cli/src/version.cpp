#include "version.h"

namespace supple::cli {

const char* program_version() { return SUPPLE_VERSION; }

}  // namespace supple::cli
