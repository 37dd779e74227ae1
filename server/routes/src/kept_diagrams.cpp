#include "kept_diagrams.h"

#include <iterator>

namespace supple::routes {

std::list<KeptDiagrams::Kept> KeptDiagrams::take(const std::shared_ptr<const store::LoadedMesh>& mesh,
                                                 double border_deviation,
                                                 std::span<const surface::SurfacePoint> sites) {
  const std::lock_guard lock(mutex_);
  std::list<Kept> taken;
  kept_.remove_if([](const Kept& kept) { return kept.mesh.expired(); });
  for (auto place = kept_.begin(); place != kept_.end(); ++place) {
    // The diagram's solver is that of the mesh, which is alive if it is this one.
    if (place->mesh.lock() != mesh || place->border_deviation != border_deviation || !place->moving.is_near(sites))
      continue;
    taken.splice(taken.begin(), kept_, place);
    break;
  }
  return taken;
}

voronoi::Diagram KeptDiagrams::diagram(const std::shared_ptr<const store::LoadedMesh>& mesh,
                                       const voronoi::DiagramOptions& options,
                                       std::span<const surface::SurfacePoint> sites, const Execution& execution) {
  // Distances that are not exact are made anew every time.
  if (options.method != voronoi::DiagramMethod::exact || mesh->mesh().face_count() > most_faces)
    return voronoi::diagram(mesh->solver(execution), sites, options, execution);
  std::list<Kept> own = take(mesh, options.border_deviation, sites);
  if (own.empty())
    own.push_back({mesh, options.border_deviation, voronoi::MovingDiagram(mesh->solver(execution), options)});
  own.front().moving.move_to(sites, execution);
  voronoi::Diagram result = own.front().moving.take_diagram();
  const std::lock_guard lock(mutex_);
  kept_.splice(kept_.begin(), own);
  if (kept_.size() > most_diagrams) own.splice(own.begin(), kept_, std::prev(kept_.end()));
  return result;
}

}  // namespace supple::routes
