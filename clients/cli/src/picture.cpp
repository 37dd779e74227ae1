#include "picture.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "failure.h"
#include "session.h"

namespace supple::cli {
namespace {

/// Pixels of a PNG for each pixel of the SVG picture.
constexpr double pixel_ratio = 2;
/// Longest side that Cairo permits, in pixels.
constexpr double max_side = 32767;

/// Makes PNG files with librsvg and Cairo. These are loaded only when a PNG is requested, so that neither building nor
/// running the program needs them otherwise.
class Rasterizer {
 public:
  static bool available() { return library() != nullptr; }

  static std::string png(const std::string& svg) {
    const auto new_from_data = function<void*(const std::uint8_t*, std::size_t, void**)>("rsvg_handle_new_from_data");
    const auto size_of = function<int(void*, double*, double*)>("rsvg_handle_get_intrinsic_size_in_pixels");
    const auto render = function<int(void*, void*, const Rectangle*, void**)>("rsvg_handle_render_document");
    const auto unref = function<void(void*)>("g_object_unref");
    const auto create_surface = function<void*(int, int, int)>("cairo_image_surface_create");
    const auto destroy_surface = function<void(void*)>("cairo_surface_destroy");
    const auto create_context = function<void*(void*)>("cairo_create");
    const auto destroy_context = function<void(void*)>("cairo_destroy");
    const auto write = function<int(void*, int (*)(void*, const unsigned char*, unsigned), void*)>(
        "cairo_surface_write_to_png_stream");

    const std::unique_ptr<void, void (*)(void*)> handle(
        new_from_data(reinterpret_cast<const std::uint8_t*>(svg.data()), svg.size(), nullptr), unref);
    Rectangle page;
    if (!handle || size_of(handle.get(), &page.width, &page.height) == 0) fail("the picture cannot be read");
    page.width = std::ceil(pixel_ratio * page.width);
    page.height = std::ceil(pixel_ratio * page.height);
    if (!(std::min(page.width, page.height) >= 1 && std::max(page.width, page.height) <= max_side))
      fail("the picture is too large; write it as .svg");
    const std::unique_ptr<void, void (*)(void*)> surface(
        create_surface(argb32, static_cast<int>(page.width), static_cast<int>(page.height)), destroy_surface);
    const std::unique_ptr<void, void (*)(void*)> context(create_context(surface.get()), destroy_context);
    if (render(handle.get(), context.get(), &page, nullptr) == 0) fail("the picture cannot be drawn");
    std::string bytes;
    if (write(surface.get(), append, &bytes) != 0) fail("the picture cannot be written");
    return bytes;
  }

 private:
  /// The layout of RsvgRectangle.
  struct Rectangle {
    double x = 0;
    double y = 0;
    double width = 0;
    double height = 0;
  };
  /// The value of CAIRO_FORMAT_ARGB32.
  static constexpr int argb32 = 0;

  [[noreturn]] static void fail(const char* what) { throw Failure(ExitCode::local_file, what); }

  static int append(void* bytes, const unsigned char* data, unsigned size) {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), size);
    return 0;
  }

  static void* library() {
    static void* const found = dlopen("librsvg-2.so.2", RTLD_NOW | RTLD_GLOBAL);
    return found;
  }

  /// A function of librsvg, or of a library that it needs, such as Cairo.
  template <class Signature>
  static Signature* function(const char* name) {
    void* const address = library() == nullptr ? nullptr : dlsym(library(), name);
    if (address == nullptr) fail("librsvg is too old to make PNG files; write the plot as .svg");
    return reinterpret_cast<Signature*>(address);
  }
};

std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

}  // namespace

CLI::Validator plot_file() {
  return {[](const std::string& path) -> std::string {
            const auto ending = ending_of(path);
            if (path == "-" || ending.empty() || ending == ".svg") return {};
            if (ending != ".png") return fmt::format("{}: plots are written as .svg or .png", path);
            if (Rasterizer::available()) return {};
            throw Failure(
                ExitCode::local_file,
                fmt::format("{}: PNG files are made by librsvg, which this machine lacks (the package librsvg2-2 "
                            "of Debian has it); write the plot as .svg",
                            path));
          },
          ""};
}

void write_picture(const std::string& path, const std::string& svg) {
  write_file(path, ending_of(path) == ".png" ? Rasterizer::png(svg) : svg);
}

}  // namespace supple::cli
