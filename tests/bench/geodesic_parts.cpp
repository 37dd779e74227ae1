// Parts as CAD programs export them, thousands of them: whether distances reach every vertex, are the same in both
// directions, obey the triangle inequality along edges, and agree with CGAL where CGAL agrees with itself.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "geodesic_bench.h"
#include "measurement.h"
#include "supple/base/error.h"
#include "support/cad_parts.h"
#include "support/cgal_geodesics.h"

namespace supple::bench {
namespace {

using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;
using testing::CadPart;
using testing::Digits;

/// Lengths that differ by less than this part of the diagonal are equal.
constexpr double kEqual = 1e-9;

/// What came out of some parts. Lengths are relative to the diagonal of the part.
struct Findings {
  int parts = 0;
  double vertices = 0;
  double fields = 0;
  double pairs = 0;
  double refused = 0;              ///< fields that ended with an error
  double unreached = 0;            ///< values that are missing on a connected part
  double asymmetric = 0;           ///< pairs whose lengths in both directions differ by more than kEqual
  double asymmetry = 0;            ///< the largest
  double excess = 0;               ///< largest, of a vertex over its neighbour plus the edge
  double cgal_against_itself = 0;  ///< pairs whose lengths by CGAL in both directions differ by more than kEqual
  double cgal_pairs = 0;           ///< the others
  double difference = 0;           ///< the largest from CGAL of those
  double seconds = 0;
  double cgal_seconds = 0;

  bool right() const {
    return refused == 0 && unreached == 0 && asymmetric == 0 && excess <= kEqual && difference <= kEqual;
  }
};

using Rows = std::vector<std::vector<double>>;

void compare(const TriangleMesh& mesh, const std::vector<std::int32_t>& sources, const Rows& ours, const Rows& cgal,
             Findings& findings) {
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::vector<double>& row = ours[i];
    if (row.empty()) continue;
    for (const double d : row) findings.unreached += !std::isfinite(d);
    for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h) {
      const double excess = row[mesh.head(h)] - row[mesh.tail(h)] - mesh.edge_length(h);
      findings.excess = std::max(findings.excess, excess / mesh.diagonal());
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (ours[k].empty()) continue;
      const double there = row[sources[k]];
      const double apart = std::abs(there - ours[k][sources[i]]) / mesh.diagonal();
      findings.pairs += 1;
      findings.asymmetric += !(apart <= kEqual);
      findings.asymmetry = std::max(findings.asymmetry, apart);
      if (cgal.empty()) continue;
      const double theirs = cgal[i][sources[k]];
      if (std::abs(theirs - cgal[k][sources[i]]) > kEqual * mesh.diagonal()) {
        findings.cgal_against_itself += 1;
        continue;
      }
      findings.cgal_pairs += 1;
      findings.difference = std::max(findings.difference, std::abs(there - theirs) / mesh.diagonal());
    }
  }
}

void examine(CadPart part, int most_sources, bool with_cgal, RandomStream& stream, Findings& findings) {
  const auto mesh = std::make_shared<const TriangleMesh>(std::move(part.mesh));
  const GeodesicSolver solver(mesh);
  std::vector<std::int32_t> sources(static_cast<std::size_t>(mesh->vertex_count()));
  for (std::int32_t v = 0; v < mesh->vertex_count(); ++v) sources[v] = v;
  for (std::size_t i = sources.size(); i-- > 1;) std::swap(sources[i], sources[stream.below(static_cast<int>(i) + 1)]);
  sources.resize(std::min<std::size_t>(sources.size(), most_sources));
  Rows ours;
  Rows cgal;
  testing::CgalGeodesics peer(*mesh);
  for (const std::int32_t v : sources) {
    const SurfacePoint source = vertex_point(*mesh, VertexId(v));
    ours.emplace_back();
    findings.seconds += cpu_time([&] {
      try {
        ours.back() = solver.field({&source, 1}).vertex_distances();
      } catch (const Error&) {
        findings.refused += 1;
      }
    });
    if (!with_cgal) continue;
    peer.set_source(source);
    findings.cgal_seconds += cpu_time([&] { peer.search(); });
    cgal.push_back(peer.vertex_distances());
  }
  findings.parts += 1;
  findings.vertices += mesh->vertex_count();
  findings.fields += static_cast<double>(sources.size());
  compare(*mesh, sources, ours, cgal, findings);
}

/// One row of findings for each way in which coordinates were written.
std::array<Findings, 3> examine_parts(int parts, int most_sources, bool with_cgal, std::uint64_t first_seed) {
  std::array<Findings, 3> all;
  for (int i = 0; i < parts; ++i) {
    RandomStream stream("cad parts", first_seed + static_cast<std::uint64_t>(i));
    CadPart part = testing::cad_part(stream);
    Findings& findings = all[static_cast<std::size_t>(part.digits)];
    examine(std::move(part), most_sources, with_cgal, stream, findings);
  }
  return all;
}

constexpr std::array kDigits{"all", "single precision", "six"};

}  // namespace

void measure_parts(Report& report, const Settings& settings) {
  report.text(
      "Each part is an extruded outline with fillets, chamfers, holes, pockets and bosses, closed or open, with "
      "vertices "
      "within straight edges, slivers, and edges split as T-vertices are mended. It is turned in space, its "
      "coordinates "
      "are rounded as a file rounds them, and some of its vertices are moved by 1e-6 to 1e-12 of its size. Lengths are "
      "relative to the diagonal of the part, and equal if they differ by less than 1e-9 of it.");
  const int parts = settings.brief ? 4 : 100;
  const int sources = settings.brief ? 10 : 40;
  report.heading(std::to_string(parts) + " parts, " + std::to_string(sources) + " sources each, against CGAL");
  Table against_cgal("geodesics-parts", {{"digits", "Digits"},
                                         {"parts", "Parts"},
                                         {"vertices", "Vertices"},
                                         {"fields", "Fields"},
                                         {"refused", "Refused"},
                                         {"unreached", "Vertices not reached"},
                                         {"pairs", "Pairs"},
                                         {"asymmetry", "Largest asymmetry"},
                                         {"excess", "Largest excess over a neighbour"},
                                         {"cgal_against_itself", "Pairs in which CGAL contradicts itself"},
                                         {"difference", "Largest difference from CGAL in the others"},
                                         {"ours_us", "Ours, us per field"},
                                         {"cgal_us", "CGAL, us per field"}});
  const auto rows = examine_parts(parts, sources, true, 0);
  bool right = true;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Findings& f = rows[i];
    if (f.parts == 0) continue;
    right = right && f.right();
    against_cgal.row({kDigits[i], std::to_string(f.parts), count(f.vertices), count(f.fields), count(f.refused),
                      count(f.unreached), count(f.pairs), number(f.asymmetry, 2), number(f.excess, 2),
                      count(f.cgal_against_itself), number(f.difference, 2), number(1e6 * f.seconds / f.fields),
                      number(1e6 * f.cgal_seconds / f.fields)});
  }
  report.table(against_cgal);
  report.target("Parts against CGAL", "every vertex reached, all lengths equal", right ? "they are" : "not all", right);

  const int many = settings.brief ? 20 : 10'000;
  report.heading(count(many) + " parts, " + std::to_string(sources / 2) + " sources each");
  Table alone("geodesics-many-parts", {{"digits", "Digits"},
                                       {"parts", "Parts"},
                                       {"fields", "Fields"},
                                       {"refused", "Refused"},
                                       {"unreached", "Vertices not reached"},
                                       {"pairs", "Pairs"},
                                       {"asymmetric", "Pairs of different lengths"},
                                       {"asymmetry", "Largest asymmetry"},
                                       {"excess", "Largest excess over a neighbour"}});
  const auto many_rows = examine_parts(many, sources / 2, false, 1'000);
  right = true;
  for (std::size_t i = 0; i < many_rows.size(); ++i) {
    const Findings& f = many_rows[i];
    if (f.parts == 0) continue;
    right = right && f.right();
    alone.row({kDigits[i], std::to_string(f.parts), count(f.fields), count(f.refused), count(f.unreached),
               count(f.pairs), count(f.asymmetric), number(f.asymmetry, 2), number(f.excess, 2)});
  }
  report.table(alone);
  report.target("Many parts", "every vertex reached, all lengths equal", right ? "they are" : "not all", right);
}

}  // namespace supple::bench
