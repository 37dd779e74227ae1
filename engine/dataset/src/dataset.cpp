#include "supple/dataset/dataset.h"

namespace supple::dataset {

std::vector<std::int64_t> Selection::indices() const {
  std::vector<std::int64_t> result;
  for (std::int64_t i = first; i < first + count; ++i)
    if (i % shards == shard) result.push_back(i);
  return result;
}

std::vector<std::int64_t> missing_designs(const Dataset& data) {
  std::vector<std::int64_t> missing;
  auto present = data.designs.begin();
  for (const std::int64_t index : data.selection.indices()) {
    while (present != data.designs.end() && present->index < index) ++present;
    if (present == data.designs.end() || present->index != index) missing.push_back(index);
  }
  return missing;
}

}  // namespace supple::dataset
