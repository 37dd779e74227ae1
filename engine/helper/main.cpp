// supple-helper: meshes, clips, orders and reads for a supple-server by libraries that look for no stop request; the
// server kills it where what it does is not wanted any more. Started by the server; see supple/base/helper_processes.h.

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
