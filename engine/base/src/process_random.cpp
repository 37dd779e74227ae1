#include "supple/base/process_random.h"

#include <cstdlib>

namespace supple {

std::unique_lock<std::mutex> lock_process_random() {
  static std::mutex mutex;
  std::unique_lock lock(mutex);
  std::srand(1);
  return lock;
}

}  // namespace supple
