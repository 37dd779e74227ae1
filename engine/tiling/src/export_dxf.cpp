#include <algorithm>
#include <array>
#include <initializer_list>
#include <utility>

#include "file_makers.h"
#include "solid_files.h"
#include "solid_patch.h"

namespace supple::tiling {
namespace {

/// Writes pairs of group code and value, a line each. Every object of a drawing has a handle, a hexadecimal number, and
/// names its owner's.
class DxfWriter {
 public:
  void pair(int code, const std::string& value) { text_ += std::to_string(code) + "\n" + value + "\n"; }
  void pairs(std::initializer_list<std::pair<int, const char*>> list) {
    for (const auto& [code, value] : list) pair(code, value);
  }
  void number(int code, double value) { pair(code, decimal(value, 6)); }
  std::string handle() { return hexadecimal(next_handle_++); }
  std::string next_handle() const { return hexadecimal(next_handle_); }
  std::string finish() { return std::move(text_); }

 private:
  static std::string hexadecimal(unsigned number) {
    std::string digits;
    for (; number > 0; number /= 16) digits += "0123456789ABCDEF"[number % 16];
    std::reverse(digits.begin(), digits.end());
    return digits;
  }

  std::string text_;
  unsigned next_handle_ = 0x100;  // lower numbers are fixed handles of the tables
};

// Handles of objects to which others refer.
constexpr const char* block_record_table = "1";
constexpr const char* model_space = "1F";
constexpr const char* paper_space = "1B";
constexpr const char* root_dictionary = "C";

struct TableHeader {
  const char* name;
  const char* handle;
  const char* entries;
};

void begin_table(DxfWriter& dxf, const TableHeader& table) {
  dxf.pairs(
      {{0, "TABLE"}, {2, table.name}, {5, table.handle}, {330, "0"}, {100, "AcDbSymbolTable"}, {70, table.entries}});
}

void begin_entry(DxfWriter& dxf, const TableHeader& table, const char* handle, const char* kind, const char* name) {
  dxf.pairs(
      {{0, table.name}, {5, handle}, {330, table.handle}, {100, "AcDbSymbolTableRecord"}, {100, kind}, {2, name}});
}

// A reader of AutoCAD R2000 expects these nine tables, however little they hold.
void write_tables(DxfWriter& dxf) {
  dxf.pairs({{0, "SECTION"}, {2, "TABLES"}});

  begin_table(dxf, {"VPORT", "8", "0"});
  dxf.pair(0, "ENDTAB");

  const TableHeader line_types = {"LTYPE", "5", "3"};
  begin_table(dxf, line_types);
  for (const auto& [handle, name, description] :
       {std::array<const char*, 3>{"14", "ByBlock", ""}, {"15", "ByLayer", ""}, {"16", "Continuous", "Solid line"}}) {
    begin_entry(dxf, line_types, handle, "AcDbLinetypeTableRecord", name);
    dxf.pairs({{70, "0"}, {3, description}, {72, "65"}, {73, "0"}, {40, "0.0"}});
  }
  dxf.pair(0, "ENDTAB");

  const TableHeader layers = {"LAYER", "2", "1"};
  begin_table(dxf, layers);
  begin_entry(dxf, layers, "10", "AcDbLayerTableRecord", "0");
  dxf.pairs({{70, "0"}, {62, "7"}, {6, "Continuous"}});
  dxf.pair(0, "ENDTAB");

  const TableHeader styles = {"STYLE", "3", "1"};
  begin_table(dxf, styles);
  begin_entry(dxf, styles, "11", "AcDbTextStyleTableRecord", "Standard");
  dxf.pairs({{70, "0"}, {40, "0.0"}, {41, "1.0"}, {50, "0.0"}, {71, "0"}, {42, "2.5"}, {3, "txt"}, {4, ""}});
  dxf.pair(0, "ENDTAB");

  begin_table(dxf, {"VIEW", "6", "0"});
  dxf.pair(0, "ENDTAB");
  begin_table(dxf, {"UCS", "7", "0"});
  dxf.pair(0, "ENDTAB");

  const TableHeader applications = {"APPID", "9", "1"};
  begin_table(dxf, applications);
  begin_entry(dxf, applications, "12", "AcDbRegAppTableRecord", "ACAD");
  dxf.pairs({{70, "0"}, {0, "ENDTAB"}});

  begin_table(dxf, {"DIMSTYLE", "A", "0"});
  dxf.pairs({{100, "AcDbDimStyleTable"}, {0, "ENDTAB"}});

  const TableHeader blocks = {"BLOCK_RECORD", block_record_table, "2"};
  begin_table(dxf, blocks);
  begin_entry(dxf, blocks, model_space, "AcDbBlockTableRecord", "*Model_Space");
  begin_entry(dxf, blocks, paper_space, "AcDbBlockTableRecord", "*Paper_Space");
  dxf.pairs({{0, "ENDTAB"}, {0, "ENDSEC"}});
}

void write_block(DxfWriter& dxf, const char* name, const char* owner, const char* begin, const char* end) {
  dxf.pairs({{0, "BLOCK"},
             {5, begin},
             {330, owner},
             {100, "AcDbEntity"},
             {8, "0"},
             {100, "AcDbBlockBegin"},
             {2, name},
             {70, "0"},
             {10, "0.0"},
             {20, "0.0"},
             {30, "0.0"},
             {3, name},
             {1, ""}});
  dxf.pairs({{0, "ENDBLK"}, {5, end}, {330, owner}, {100, "AcDbEntity"}, {8, "0"}, {100, "AcDbBlockEnd"}});
}

void write_polyline(DxfWriter& dxf, const Polygon& polygon) {
  dxf.pairs({{0, "LWPOLYLINE"}});
  dxf.pair(5, dxf.handle());
  dxf.pairs({{330, model_space}, {100, "AcDbEntity"}, {8, "0"}, {100, "AcDbPolyline"}});
  dxf.pair(90, std::to_string(polygon.size()));
  dxf.pair(70, "1");  // closed
  for (const Eigen::Vector2d& p : polygon) {
    dxf.number(10, p.x());
    dxf.number(20, p.y());
  }
}

}  // namespace

std::string dxf_of(const std::vector<Face>& faces, const std::string& title) {
  DxfWriter entities;
  for (const Face& face : faces) {
    for (const Polygon& polygon : face) write_polyline(entities, polygon);
  }

  DxfWriter dxf;
  if (!title.empty()) dxf.pair(999, title);                                                                 // a comment
  dxf.pairs({{0, "SECTION"}, {2, "HEADER"}, {9, "$ACADVER"}, {1, "AC1015"}, {9, "$INSUNITS"}, {70, "4"}});  // mm
  dxf.pairs({{9, "$MEASUREMENT"}, {70, "1"}, {9, "$HANDSEED"}});
  dxf.pair(5, entities.next_handle());
  dxf.pairs({{0, "ENDSEC"}, {0, "SECTION"}, {2, "CLASSES"}, {0, "ENDSEC"}});
  write_tables(dxf);
  dxf.pairs({{0, "SECTION"}, {2, "BLOCKS"}});
  write_block(dxf, "*Model_Space", model_space, "20", "21");
  write_block(dxf, "*Paper_Space", paper_space, "1C", "1D");
  dxf.pairs({{0, "ENDSEC"}, {0, "SECTION"}, {2, "ENTITIES"}});
  std::string text = dxf.finish() + entities.finish();

  DxfWriter objects;
  objects.pairs({{0, "ENDSEC"}, {0, "SECTION"}, {2, "OBJECTS"}, {0, "DICTIONARY"}, {5, root_dictionary}, {330, "0"}});
  objects.pairs({{100, "AcDbDictionary"}, {281, "1"}, {3, "ACAD_GROUP"}, {350, "D"}});
  objects.pairs({{0, "DICTIONARY"}, {5, "D"}, {330, root_dictionary}, {100, "AcDbDictionary"}, {281, "1"}});
  objects.pairs({{0, "ENDSEC"}, {0, "EOF"}});
  return text + objects.finish();
}

std::string make_dxf(const Structure& structure, const ExportOptions& options) {
  return dxf_of(solid_patch(structure, options), "");
}

}  // namespace supple::tiling
