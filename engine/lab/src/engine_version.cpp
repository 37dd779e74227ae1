#include "supple/lab/engine_version.h"

namespace supple::lab {

std::string engine_version() { return SUPPLE_ENGINE_VERSION; }

}  // namespace supple::lab
