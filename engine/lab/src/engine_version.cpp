#include "supple/lab/dataset_options.h"

namespace supple::lab {

std::string engine_version() { return SUPPLE_ENGINE_VERSION; }

}  // namespace supple::lab
