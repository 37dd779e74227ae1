#include "diagram_cache.h"

#include <iterator>

namespace supple::routes {

std::list<DiagramCache::Entry> DiagramCache::take(const std::shared_ptr<const store::LoadedMesh>& mesh,
                                                  double border_deviation,
                                                  std::span<const surface::SurfacePoint> sites) {
  const std::lock_guard lock(mutex_);
  std::list<Entry> taken;
  entries_.remove_if([](const Entry& entry) { return entry.mesh.expired(); });
  for (auto place = entries_.begin(); place != entries_.end(); ++place) {
    // The diagram's solver is that of the mesh, which is alive if it is this one.
    if (place->mesh.lock() != mesh || place->border_deviation != border_deviation || !place->moving.is_near(sites))
      continue;
    taken.splice(taken.begin(), entries_, place);
    break;
  }
  return taken;
}

voronoi::Diagram DiagramCache::diagram(const std::shared_ptr<const store::LoadedMesh>& mesh,
                                       const voronoi::DiagramOptions& options,
                                       std::span<const surface::SurfacePoint> sites, const Execution& execution) {
  // A diagram of approximate distances is computed anew every time.
  if (options.method != voronoi::DiagramMethod::exact || mesh->mesh().face_count() > max_faces)
    return voronoi::diagram(mesh->solver(execution), sites, options, execution);
  std::list<Entry> own = take(mesh, options.border_deviation, sites);
  if (own.empty())
    own.push_back({mesh, options.border_deviation, voronoi::MovingDiagram(mesh->solver(execution), options)});
  own.front().moving.move_to(sites, execution);
  voronoi::Diagram result = own.front().moving.take_diagram();
  const std::lock_guard lock(mutex_);
  entries_.splice(entries_.begin(), own);
  if (entries_.size() > max_diagrams) own.splice(own.begin(), entries_, std::prev(entries_.end()));
  return result;
}

}  // namespace supple::routes
