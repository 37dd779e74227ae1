#include "version.h"

namespace supple {

const char* server_version() { return SUPPLE_VERSION; }

}  // namespace supple
