#pragma once

#include <mutex>
#include <string>

namespace supple::meshing {

/// Exclusive access to gmsh while this object lives: gmsh has one global state, whose users wait for each other. It
/// prints nothing, reads no file, installs no signal handler, draws the same random numbers every time and uses the
/// calling thread alone.
///
/// Each kind of mesh sets its options every time, because other kinds may have changed them.
class GmshSession {
 public:
  GmshSession();

 private:
  std::unique_lock<std::mutex> random_lock_;
  std::unique_lock<std::mutex> gmsh_lock_;
};

/// An empty model that is current while this object lives, within a session.
class GmshModel {
 public:
  explicit GmshModel(const GmshSession& session);
  ~GmshModel();
  GmshModel(const GmshModel&) = delete;
  GmshModel& operator=(const GmshModel&) = delete;
};

/// The last error message of gmsh; empty for none.
std::string last_gmsh_error(const GmshSession& session);

}  // namespace supple::meshing
