// A mesh of more than a million faces: time and memory of each stage.
#include "geodesic_bench.h"
#include "measurement.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

/// Measures one stage after the other: CPU time, memory that remains, and the peak of memory.
class LargeMeshStages {
 public:
  explicit LargeMeshStages(Table& table) : table_(table) {}

  template <typename Action>
  double stage(const std::string& name, std::int32_t faces, Action&& action) {
    reset_peak_memory();
    const std::int64_t before = resident_bytes();
    const double seconds = cpu_time(action);
    const auto per_face = [&](std::int64_t bytes) { return count(static_cast<double>(bytes - before) / faces); };
    const std::string peak = per_face(peak_resident_bytes());
    table_.row({name, number(seconds), per_face(resident_bytes()), peak});
    return seconds;
  }

 private:
  Table& table_;
};

}  // namespace

void study_large_mesh(const Settings& settings) {
  const int subdivisions = settings.brief ? 5 : 8;
  const std::int32_t faces = 20 << (2 * subdivisions);
  Report report(settings.folder, "geodesics", "large-mesh", "A mesh of " + count(faces) + " faces");
  Table table("geodesics-large-mesh", {{"stage", "Stage"},
                                       {"s", "Seconds"},
                                       {"bytes_per_face", "Bytes per face that stay"},
                                       {"peak_bytes_per_face", "Bytes per face at the peak"}});
  LargeMeshStages stages(table);
  std::shared_ptr<const surface::TriangleMesh> mesh;
  std::unique_ptr<surface::GeodesicSolver> solver;
  {
    surface::TriangleMesh made = testing::icosphere(subdivisions);
    std::vector<Eigen::Vector3d> positions = made.positions();
    std::vector<surface::Triangle> triangles = made.faces();
    made = {};
    stages.stage("mesh from vertices and faces", faces, [&] {
      mesh = std::make_shared<const surface::TriangleMesh>(
          surface::TriangleMesh::build(std::move(positions), std::move(triangles)));
    });
  }
  stages.stage("solver", faces, [&] { solver = std::make_unique<surface::GeodesicSolver>(mesh); });
  RandomStream stream("large mesh", 37);
  const std::vector<surface::SurfacePoint> source{testing::random_point(*mesh, stream)};
  double windows = 0;
  const double seconds = stages.stage("one to all, exact", faces,
                                      [&] { windows = static_cast<double>(solver->field(source).window_count()); });
  // An exact field of this size would keep gigabytes; one within one per cent does not.
  surface::FieldOptions options;
  options.relative_error = 0.01;
  stages.stage("one to all within 1 %", faces, [&] { keep(solver->field(source, options).vertex_distances()[0]); });
  options.keep_windows = true;
  std::unique_ptr<surface::GeodesicField> kept;
  stages.stage("the same, kept for queries", faces,
               [&] { kept = std::make_unique<surface::GeodesicField>(solver->field(source, options)); });

  if (!settings.brief) {
    report.target("More than a million faces, one to all in one run", "runs",
                  count(faces) + " faces in " + number(seconds) + " s", true);
  }
  report.table(table);
  report.write("bench_geodesics large-mesh", settings.brief,
               "An icosphere. The search made " + count(windows) + " windows, " + number(windows / faces) +
                   " per face, in " + number(1e9 * seconds / windows) + " ns each: " + count(faces / seconds) +
                   " faces per second. Memory is the growth of the process's resident memory over a stage. The first "
                   "search makes the state that later ones reuse.");
}

}  // namespace supple::bench
