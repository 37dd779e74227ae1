#include "face_targets.h"

namespace supple::surface {

FaceTargets::FaceTargets(const TriangleMesh& mesh) : mesh_(mesh) {
  faces_.resize(static_cast<std::size_t>(mesh.face_count()), FaceRecord{0, -1});
}

void FaceTargets::start(std::uint32_t epoch, std::span<SearchTarget> targets) {
  if (epoch == 1) {
    for (FaceRecord& record : faces_) record.epoch = 0;
  }
  epoch_ = epoch;
  links_.clear();
  targets_ = targets;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const SearchTarget& target = targets[i];
    if (target.vertex < 0) {
      add(index(target.point.face), static_cast<std::int32_t>(i));
      continue;
    }
    const std::int32_t first = mesh_.outgoing(target.vertex);
    std::int32_t h = first;
    do {
      add(TriangleMesh::face_of(h), static_cast<std::int32_t>(i));
      h = mesh_.rotate(h);
    } while (h >= 0 && h != first);
  }
}

void FaceTargets::add(std::int32_t face, std::int32_t target) {
  FaceRecord& record = faces_[face];
  if (record.epoch != epoch_) record = {epoch_, -1};
  links_.push_back({target, record.first_link});
  record.first_link = static_cast<std::int32_t>(links_.size()) - 1;
}

}  // namespace supple::surface
