// supple-helper meshes, clips, orders and reads for a supple-server, with libraries that check for no stop request. The
// server starts it, and kills it if its result is no longer wanted; see supple/base/helper_processes.h.

#include <utility>

#include "supple/meshing/helper_tasks.h"
#include "supple/neural/helper_tasks.h"
#include "supple/numerics/helper_tasks.h"
#include "supple/tiling/helper_tasks.h"

int main(int argc, char** argv) {
  supple::HelperTasks tasks = supple::meshing::helper_tasks();
  tasks.merge(supple::neural::helper_tasks());
  tasks.merge(supple::numerics::helper_tasks());
  tasks.merge(supple::tiling::helper_tasks());
  supple::meshing::prepare_helper();
  return supple::serve_as_helper(argc, argv, tasks);
}
