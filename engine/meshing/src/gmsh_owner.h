#pragma once

#include <mutex>
#include <string>

namespace supple::meshing {

/// gmsh while this object lives: one global state, whose users wait for each other. It prints nothing, reads no file,
/// installs no signal handler, draws the same random numbers every time and uses the calling thread alone.
///
/// Options that one kind of mesh needs are set by it every time: others have left theirs.
class GmshSession {
 public:
  GmshSession();

 private:
  std::unique_lock<std::mutex> random_;
  std::unique_lock<std::mutex> own_;
};

/// An empty model that is current while this object lives, within a session.
class GmshModel {
 public:
  explicit GmshModel(const GmshSession& session);
  ~GmshModel();
  GmshModel(const GmshModel&) = delete;
  GmshModel& operator=(const GmshModel&) = delete;
};

/// What gmsh said last, empty where it said nothing.
std::string last_gmsh_error(const GmshSession& session);

}  // namespace supple::meshing
