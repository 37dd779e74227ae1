// supple-helper: makes meshes and files of structures for a supple-server, which kills it where they are not wanted any
// more. Started by the server; see supple/base/helper_processes.h.

#include <utility>

#include "supple/meshing/helper_tasks.h"
#include "supple/tiling/helper_tasks.h"

int main(int argc, char** argv) {
  supple::HelperTasks tasks = supple::meshing::helper_tasks();
  tasks.merge(supple::tiling::helper_tasks());
  return supple::serve_as_helper(argc, argv, tasks);
}
