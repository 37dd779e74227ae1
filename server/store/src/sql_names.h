#pragma once

#include <string>
#include <vector>

#include "supple/store/records.h"

namespace supple::store {

/// The names of states as a list in SQL: 'accepted', 'running'. They are constants of this program, which need no
/// escaping.
inline std::string sql_names(const std::vector<JobState>& states) {
  std::string names;
  for (const auto state : states) names.append(names.empty() ? "'" : ", '").append(state_name(state)).append("'");
  return names;
}

}  // namespace supple::store
