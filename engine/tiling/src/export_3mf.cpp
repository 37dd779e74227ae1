#include <zip.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "solid_files.h"
#include "supple/base/file_text.h"

namespace supple::tiling {
namespace {

constexpr std::string_view content_types =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
)";
constexpr std::string_view relationships =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
)";

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};

/// A ZIP archive of texts, which libzip makes in memory.
std::string zip_of(const std::vector<std::pair<const char*, std::string_view>>& files) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const bytes = zip_source_buffer_create(nullptr, 0, 0, &error);
  if (!bytes) throw std::runtime_error("A 3MF package could not be begun.");
  zip_source_keep(bytes);
  std::unique_ptr<zip_t, Discard> archive(zip_open_from_source(bytes, ZIP_TRUNCATE, &error));
  bool good = archive != nullptr;
  for (const auto& [name, text] : files) {
    zip_source_t* const source = good ? zip_source_buffer(archive.get(), text.data(), text.size(), 0) : nullptr;
    const zip_int64_t index = source ? zip_file_add(archive.get(), name, source, ZIP_FL_ENC_UTF_8) : -1;
    // The time is a fixed one, so that equal requests have equal files.
    good = index >= 0 && zip_file_set_dostime(archive.get(), static_cast<zip_uint64_t>(index), 0, (1 << 5) | 1, 0) == 0;
  }
  good = good && zip_close(archive.get()) == 0;
  if (good) (void)archive.release();
  std::string package;
  zip_stat_t stat;
  if (good && zip_source_stat(bytes, &stat) == 0 && zip_source_open(bytes) == 0) {
    package.resize(stat.size);
    good = zip_source_read(bytes, package.data(), stat.size) == static_cast<zip_int64_t>(stat.size);
    zip_source_close(bytes);
  }
  zip_source_free(bytes);
  if (!good || package.empty()) throw std::runtime_error("A 3MF package could not be written.");
  return package;
}

/// Numbers the points of the plane; points with equal coordinates have one number.
class Nodes {
 public:
  std::size_t at(const Eigen::Vector2d& p) {
    const auto [entry, is_new] = numbers_.try_emplace({p.x(), p.y()}, points_.size());
    if (is_new) points_.push_back(p);
    return entry->second;
  }
  const std::vector<Eigen::Vector2d>& points() const { return points_; }

 private:
  std::map<std::pair<double, double>, std::size_t> numbers_;
  std::vector<Eigen::Vector2d> points_;
};

/// The text escaped for an attribute, without control characters.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return result;
}

/// Writes the triangles of a solid into `triangles`, and returns its nodes in the plane.
///
/// Node k of the plane is two nodes of the solid: 2 k at the bottom and 2 k + 1 at the top. 3MF requires that
/// neighbouring triangles share the indices of their nodes. A corner at which two parts of one face touch is one node.
std::vector<Eigen::Vector2d> write_triangles(const NamedSolid& solid, FileText& triangles) {
  Nodes nodes;
  const auto add = [&triangles](std::size_t a, std::size_t b, std::size_t c) {
    triangles << "<triangle v1=\"";
    triangles.number(a, '"') << " v2=\"";
    triangles.number(b, '"') << " v3=\"";
    triangles.number(c, '"') << "/>\n";
  };
  const auto& caps = solid.caps;
  for (const auto& [a, b, c] : caps.triangles) {
    const std::size_t p = 2 * nodes.at(caps.points[a]), q = 2 * nodes.at(caps.points[b]),
                      r = 2 * nodes.at(caps.points[c]);
    add(p + 1, q + 1, r + 1);
    add(p, r, q);
  }
  for (const Face& face : solid.faces) {
    for (const Polygon& polygon : face) {
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const std::size_t p = 2 * nodes.at(polygon[k]), q = 2 * nodes.at(polygon[(k + 1) % polygon.size()]);
        add(p, q, q + 1);
        add(p, q + 1, p + 1);
      }
    }
  }
  return nodes.points();
}

void write_object(FileText& model, std::size_t id, const NamedSolid& solid, double thickness) {
  FileText triangles;
  const auto nodes = write_triangles(solid, triangles);
  model << "<object id=\"";
  model.number(id, '"') << " type=\"model\" name=\"" << escaped(solid.name) << "\">\n<mesh>\n<vertices>\n";
  for (const Eigen::Vector2d& p : nodes) {
    for (const double z : {0.0, thickness}) {
      model << "<vertex x=\"";
      model.number(p.x(), '"') << " y=\"";
      model.number(p.y(), '"') << " z=\"";
      model.number(z, '"') << "/>\n";
    }
  }
  model << "</vertices>\n<triangles>\n" << triangles.take() << "</triangles>\n</mesh>\n</object>\n";
}

}  // namespace

std::string three_mf_of(const std::vector<NamedSolid>& solids, double thickness, const std::string& title) {
  FileText model;
  model << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" "
           "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<metadata name=\"Title\">"
        << title << "</metadata>\n<resources>\n";
  std::size_t id = 0;
  for (const NamedSolid& solid : solids) write_object(model, ++id, solid, thickness);
  if (solids.size() > 1) {
    model << "<object id=\"";
    model.number(id + 1, '"') << " type=\"model\" name=\"" << title << "\">\n<components>\n";
    for (std::size_t component = 1; component <= solids.size(); ++component) {
      model << "<component objectid=\"";
      model.number(component, '"') << "/>\n";
    }
    model << "</components>\n</object>\n";
    ++id;
  }
  model << "</resources>\n<build><item objectid=\"";
  model.number(id, '"') << "/></build>\n</model>\n";
  const std::string text = model.take();
  return zip_of({{"[Content_Types].xml", content_types}, {"_rels/.rels", relationships}, {"3D/3dmodel.model", text}});
}

}  // namespace supple::tiling
