// Queries per second against the number of threads that share one solver.
#include <algorithm>
#include <barrier>
#include <functional>
#include <thread>

#include "geodesic_bench.h"
#include "measurement.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

struct Work {
  std::string name;
  int queries;  ///< for each thread
  std::function<void(int)> query;
};

struct Rate {
  double per_second = 0;
  double cpu_per_query = 0;
};

/// The threads start together, and each makes all queries in an order that begins elsewhere.
Rate rate(const Work& work, int threads) {
  std::barrier start(threads + 1);
  std::vector<std::thread> workers;
  for (int t = 0; t < threads; ++t) {
    workers.emplace_back([&, t] {
      start.arrive_and_wait();
      for (int i = 0; i < work.queries; ++i) work.query((i + t * work.queries / threads) % work.queries);
    });
  }
  const double cpu = cpu_seconds();
  const double wall = wall_seconds();
  start.arrive_and_wait();
  for (std::thread& worker : workers) worker.join();
  const double total = static_cast<double>(threads) * work.queries;
  return {total / (wall_seconds() - wall), (cpu_seconds() - cpu) / total};
}

}  // namespace

void study_throughput(const Settings& settings) {
  Report report(settings.folder, "geodesics", "throughput", "Throughput against threads");
  const auto mesh = std::make_shared<const surface::TriangleMesh>(testing::icosphere(settings.brief ? 4 : 5));
  const surface::GeodesicSolver solver(mesh);
  const std::vector<PointPair> near = near_pairs(*mesh, 2000, 3, 41);
  const std::vector<PointPair> far = far_pairs(*mesh, 200, 43);
  const int scale = settings.brief ? 10 : 1;
  const std::vector<Work> works{
      {"near pairs", 60'000 / scale,
       [&](int i) { keep(solver.distance(near[i % near.size()].first, near[i % near.size()].second)); }},
      {"far pairs", 1000 / scale,
       [&](int i) { keep(solver.distance(far[i % far.size()].first, far[i % far.size()].second)); }},
      {"fields", 40 / scale, [&](int i) {
         keep(solver.field({&far[i % far.size()].first, 1}).vertex_distances()[0]);
       }}};
  const int max_threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<int> thread_counts;
  for (int threads = 1; threads < max_threads; threads *= 2) thread_counts.push_back(threads);
  thread_counts.push_back(max_threads);

  Table table("geodesics-throughput", {{"what", "What"},
                                       {"threads", "Threads"},
                                       {"per_second", "Queries per second"},
                                       {"speedup", "Over one thread"},
                                       {"cpu_us", "CPU us per query"}});
  for (const Work& work : works) {
    double alone = 0;
    for (const int threads : thread_counts) {
      std::vector<double> rates, cpu;
      for (int pass = 0; pass < 3; ++pass) {
        const Rate r = rate(work, threads);
        rates.push_back(r.per_second);
        cpu.push_back(r.cpu_per_query);
      }
      const double best = *std::max_element(rates.begin(), rates.end());
      if (threads == 1) alone = best;
      table.row({work.name, std::to_string(threads), count(best), number(best / alone), number(1e6 * least(cpu))});
    }
  }
  report.table(table);
  report.write("bench_geodesics throughput", settings.brief,
               "One solver on an icosphere of " + count(mesh->face_count()) +
                   " faces, shared by all threads; each has its own search state. The best of three passes in wall "
                   "time, which suffers from whatever else the machine does; CPU time per query tells whether the "
                   "threads disturb each other.");
}

}  // namespace supple::bench
