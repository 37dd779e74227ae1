#include "supple/files/hdf5_file.h"

#include <hdf5.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <type_traits>
#include <utility>

#include "supple/base/error.h"

namespace supple::files {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t>, "an HDF5 identifier is held as a 64-bit integer");

/// Rows of one chunk of a compressed column: 128 KiB of doubles.
constexpr hsize_t chunk_rows = 16384;
constexpr unsigned deflate_level = 6;
/// Limit of the columns of a table, whose number is an int.
constexpr hsize_t max_columns = 1U << 20U;

[[noreturn]] void throw_unwritable(const std::filesystem::path& path, const std::string& what) {
  throw Error("file.write_failed", "HDF5 cannot write " + what + " of " + path.string() + ".");
}
[[noreturn]] void throw_unreadable(const std::filesystem::path& path, const std::string& what) {
  throw Error("file.unreadable", path.string() + ": " + what + ".");
}

/// Keeps HDF5 from printing errors, which are thrown here.
void silence_hdf5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

template <class T>
hid_t memory_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
  return H5T_NATIVE_UINT8;
}

template <class T>
hid_t file_type(const ColumnStorage& storage) {
  if constexpr (std::is_same_v<T, double>) return storage.single_precision ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_STD_I64LE;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_STD_I32LE;
  return H5T_STD_U8LE;
}

/// A name for a file in memory. HDF5 requires that no such file exists, and below /dev/null there can be none. Each
/// name is new, since HDF5 takes two open files of one name for the same file.
std::string name_in_memory() {
  static std::atomic<std::uint64_t> count{0};
  return "/dev/null/in-memory-" + std::to_string(++count);
}

/// The access properties of a file in memory.
Hdf5Handle in_memory() {
  constexpr std::size_t growth = 1 << 20;  // bytes by which the file grows at a time
  Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), growth, false);
  return access;
}

Hdf5Handle text_type() {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

Hdf5Handle scalar_space() { return {H5Screate(H5S_SCALAR), H5Sclose}; }

Hdf5Handle creation_properties(const std::vector<hsize_t>& shape, bool compressed) {
  Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  if (compressed && shape[0] > 0) {
    auto chunk = shape;
    chunk[0] = std::min(chunk[0], chunk_rows);
    H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data());
    H5Pset_shuffle(properties.get());
    H5Pset_deflate(properties.get(), deflate_level);
  }
  return properties;
}

std::vector<hsize_t> shape_of(hid_t object) {
  const Hdf5Handle space(H5Dget_space(object), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(rank, 0)));
  H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  return shape;
}

Hdf5Handle open_column(hid_t file, const std::filesystem::path& path, const std::string& name) {
  Hdf5Handle column(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (column.get() < 0) throw_unreadable(path, name + " is missing");
  return column;
}

H5T_class_t class_of(hid_t column) {
  const Hdf5Handle type(H5Dget_type(column), H5Tclose);
  return H5Tget_class(type.get());
}

/// The n variable-length strings of a column, or the one of a scalar.
std::vector<std::string> read_texts(hid_t column, std::size_t n, const std::filesystem::path& path,
                                    const std::string& name) {
  const Hdf5Handle stored(H5Dget_type(column), H5Tclose);
  if (H5Tget_class(stored.get()) != H5T_STRING || H5Tis_variable_str(stored.get()) <= 0)
    throw_unreadable(path, name + " is not text");
  const Hdf5Handle type = text_type();
  std::vector<char*> raw(n, nullptr);
  if (n > 0 && H5Dread(column, type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, raw.data()) < 0)
    throw_unreadable(path, name + " cannot be read");
  std::vector<std::string> texts;
  texts.reserve(n);
  for (const char* text : raw) texts.emplace_back(text ? text : "");
  const Hdf5Handle space(H5Dget_space(column), H5Sclose);
  H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, raw.data());
  return texts;
}

}  // namespace

Hdf5Handle& Hdf5Handle::operator=(Hdf5Handle&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
  }
  return *this;
}

bool Hdf5Handle::reset() noexcept {
  if (id_ < 0) return true;
  return close_(std::exchange(id_, -1)) >= 0;
}

Hdf5Writer::Hdf5Writer(const std::filesystem::path& path) : path_(path) {
  silence_hdf5();
  file_ = {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose};
  if (file_.get() < 0) throw_unwritable(path, "the file");
}

Hdf5Writer::Hdf5Writer() : path_("a file in memory") {
  silence_hdf5();
  const Hdf5Handle access = in_memory();
  file_ = {H5Fcreate(name_in_memory().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose};
  if (file_.get() < 0) throw_unwritable(path_, "the file");
}

std::string Hdf5Writer::bytes() const {
  const bool is_flushed = H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) >= 0;
  const auto size = is_flushed ? H5Fget_file_image(file_.get(), nullptr, 0) : -1;
  if (size < 0) throw_unwritable(path_, "the bytes");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file_.get(), bytes.data(), bytes.size()) != size) throw_unwritable(path_, "the bytes");
  return bytes;
}

void Hdf5Writer::group(const std::string& name) {
  const Hdf5Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_link_creation_order(properties.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  const Hdf5Handle created(H5Gcreate2(file_.get(), name.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Gclose);
  if (created.get() < 0) throw_unwritable(path_, name);
}

template <class T>
void Hdf5Writer::column(const std::string& name, const std::vector<T>& values, int components, ColumnStorage storage) {
  std::vector<hsize_t> shape{values.size()};
  if (components > 0) {
    shape[0] /= static_cast<hsize_t>(components);
    shape.push_back(static_cast<hsize_t>(components));
  }
  const Hdf5Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const Hdf5Handle properties = creation_properties(shape, storage.compressed);
  const Hdf5Handle created(H5Dcreate2(file_.get(), name.c_str(), file_type<T>(storage), space.get(), H5P_DEFAULT,
                                      properties.get(), H5P_DEFAULT),
                           H5Dclose);
  if (created.get() < 0 ||
      (!values.empty() && H5Dwrite(created.get(), memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0))
    throw_unwritable(path_, name);
}
template void Hdf5Writer::column(const std::string&, const std::vector<double>&, int, ColumnStorage);
template void Hdf5Writer::column(const std::string&, const std::vector<std::int64_t>&, int, ColumnStorage);
template void Hdf5Writer::column(const std::string&, const std::vector<std::int32_t>&, int, ColumnStorage);
template void Hdf5Writer::column(const std::string&, const std::vector<std::uint8_t>&, int, ColumnStorage);

void Hdf5Writer::column(const std::string& name, const std::vector<std::string>& values) {
  const std::vector<hsize_t> shape{values.size()};
  std::vector<const char*> raw;
  raw.reserve(values.size());
  for (const auto& value : values) raw.push_back(value.c_str());
  const Hdf5Handle type = text_type();
  const Hdf5Handle space(H5Screate_simple(1, shape.data(), nullptr), H5Sclose);
  const Hdf5Handle properties = creation_properties(shape, false);
  const Hdf5Handle created(
      H5Dcreate2(file_.get(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose);
  if (created.get() < 0 ||
      (!raw.empty() && H5Dwrite(created.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, raw.data()) < 0))
    throw_unwritable(path_, name);
}

namespace {

void write_scalar(hid_t file, const std::filesystem::path& path, const std::string& name, hid_t stored, hid_t memory,
                  const void* value) {
  const Hdf5Handle space = scalar_space();
  const Hdf5Handle properties = creation_properties({}, false);
  const Hdf5Handle created(
      H5Dcreate2(file, name.c_str(), stored, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Dclose);
  if (created.get() < 0 || H5Dwrite(created.get(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) < 0)
    throw_unwritable(path, name);
}

void write_attribute(hid_t file, const std::filesystem::path& path, const std::string& object, const std::string& name,
                     hid_t stored, hid_t memory, const void* value) {
  const Hdf5Handle space = scalar_space();
  const Hdf5Handle created(
      H5Acreate_by_name(file, object.c_str(), name.c_str(), stored, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  if (created.get() < 0 || H5Awrite(created.get(), memory, value) < 0)
    throw_unwritable(path, "the attribute " + name + " of " + object);
}

}  // namespace

void Hdf5Writer::value(const std::string& name, std::int64_t value) {
  write_scalar(file_.get(), path_, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}
void Hdf5Writer::value(const std::string& name, double value) {
  write_scalar(file_.get(), path_, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}
void Hdf5Writer::value(const std::string& name, const std::string& value) {
  const Hdf5Handle type = text_type();
  const char* raw = value.c_str();
  write_scalar(file_.get(), path_, name, type.get(), type.get(), static_cast<const void*>(&raw));
}

void Hdf5Writer::attribute(const std::string& object, const std::string& name, const std::string& text) {
  const Hdf5Handle type = text_type();
  const char* raw = text.c_str();
  write_attribute(file_.get(), path_, object, name, type.get(), type.get(), static_cast<const void*>(&raw));
}
void Hdf5Writer::attribute(const std::string& object, const std::string& name, std::int64_t value) {
  write_attribute(file_.get(), path_, object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}

void Hdf5Writer::close() {
  if (!file_.reset()) throw_unwritable(path_, "the end");
}

Hdf5Reader::Hdf5Reader(const std::filesystem::path& path) : path_(path) {
  silence_hdf5();
  if (!std::filesystem::exists(path)) throw_unreadable(path, "there is no such file");
  file_ = {H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose};
  if (file_.get() < 0) throw_unreadable(path, "it is no HDF5 file, or damaged");
}

Hdf5Reader::Hdf5Reader(std::string_view bytes, const std::string& name) : path_(name) {
  silence_hdf5();
  const Hdf5Handle access = in_memory();
  // HDF5 copies the bytes, although it takes a pointer that is not const.
  if (H5Pset_file_image(access.get(), const_cast<char*>(bytes.data()), bytes.size()) >= 0)
    file_ = {H5Fopen(name_in_memory().c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose};
  if (file_.get() < 0) throw_unreadable(path_, "it is no HDF5 file, or damaged");
}

std::vector<std::string> Hdf5Reader::members(const std::string& group) const {
  const Hdf5Handle opened(H5Gopen2(file_.get(), group.c_str(), H5P_DEFAULT), H5Gclose);
  H5G_info_t info;
  if (opened.get() < 0 || H5Gget_info(opened.get(), &info) < 0) throw_unreadable(path_, group + " is missing");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto length =
        H5Lget_name_by_idx(opened.get(), ".", H5_INDEX_CRT_ORDER, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    if (length < 0) throw_unreadable(path_, group + " does not keep the order of its members");
    std::string name(static_cast<std::size_t>(length) + 1, '\0');
    H5Lget_name_by_idx(opened.get(), ".", H5_INDEX_CRT_ORDER, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
    name.pop_back();
    names.push_back(std::move(name));
  }
  return names;
}

bool Hdf5Reader::contains(const std::string& name) const {
  return H5Lexists(file_.get(), name.c_str(), H5P_DEFAULT) > 0;
}

Hdf5Reader::Kind Hdf5Reader::kind(const std::string& name) const {
  const Hdf5Handle column = open_column(file_.get(), path_, name);
  switch (class_of(column.get())) {
    case H5T_INTEGER:
      return Kind::integer;
    case H5T_FLOAT:
      return shape_of(column.get()).empty() ? Kind::real : Kind::reals;
    case H5T_STRING:
      return Kind::text;
    default:
      throw_unreadable(path_, name + " is neither a number nor text");
  }
}

template <class T>
std::vector<T> Hdf5Reader::column(const std::string& name, int components, std::int64_t rows) const {
  const Hdf5Handle column = open_column(file_.get(), path_, name);
  const auto shape = shape_of(column.get());
  const bool has_shape =
      components == 0 ? shape.size() == 1 : shape.size() == 2 && shape[1] == static_cast<hsize_t>(components);
  if (!has_shape || (rows >= 0 && shape[0] != static_cast<hsize_t>(rows)))
    throw_unreadable(path_, name + " does not have the shape of its table");
  const auto kind = class_of(column.get());
  if (kind != (std::is_floating_point_v<T> ? H5T_FLOAT : H5T_INTEGER))
    throw_unreadable(path_, name + " holds another type of values");
  std::vector<T> values(shape[0] * static_cast<hsize_t>(std::max(components, 1)));
  if (!values.empty() && H5Dread(column.get(), memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw_unreadable(path_, name + " cannot be read");
  return values;
}
template std::vector<double> Hdf5Reader::column(const std::string&, int, std::int64_t) const;
template std::vector<std::int64_t> Hdf5Reader::column(const std::string&, int, std::int64_t) const;
template std::vector<std::int32_t> Hdf5Reader::column(const std::string&, int, std::int64_t) const;
template std::vector<std::uint8_t> Hdf5Reader::column(const std::string&, int, std::int64_t) const;

std::vector<std::string> Hdf5Reader::text_column(const std::string& name, std::int64_t rows) const {
  const Hdf5Handle column = open_column(file_.get(), path_, name);
  const auto shape = shape_of(column.get());
  if (shape.size() != 1 || (rows >= 0 && shape[0] != static_cast<hsize_t>(rows)))
    throw_unreadable(path_, name + " does not have the shape of its table");
  return read_texts(column.get(), shape[0], path_, name);
}

std::int64_t Hdf5Reader::integer(const std::string& name) const {
  const Hdf5Handle column = open_column(file_.get(), path_, name);
  std::int64_t value = 0;
  if (!shape_of(column.get()).empty() || class_of(column.get()) != H5T_INTEGER ||
      H5Dread(column.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) < 0)
    throw_unreadable(path_, name + " is not one integer");
  return value;
}

double Hdf5Reader::real(const std::string& name) const {
  const Hdf5Handle column = open_column(file_.get(), path_, name);
  double value = 0;
  if (!shape_of(column.get()).empty() || class_of(column.get()) != H5T_FLOAT ||
      H5Dread(column.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) < 0)
    throw_unreadable(path_, name + " is not one number");
  return value;
}

std::string Hdf5Reader::text(const std::string& name) const {
  const Hdf5Handle column = open_column(file_.get(), path_, name);
  if (!shape_of(column.get()).empty()) throw_unreadable(path_, name + " is not one text");
  return read_texts(column.get(), 1, path_, name).front();
}

std::string Hdf5Reader::text_attribute(const std::string& object, const std::string& name) const {
  const Hdf5Handle attribute(H5Aopen_by_name(file_.get(), object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
  const Hdf5Handle type = text_type();
  char* raw = nullptr;
  if (attribute.get() < 0 || H5Aread(attribute.get(), type.get(), static_cast<void*>(&raw)) < 0)
    throw_unreadable(path_, "the attribute " + name + " of " + object + " is missing");
  std::string text = raw ? raw : "";
  H5free_memory(raw);
  return text;
}

std::int64_t Hdf5Reader::integer_attribute(const std::string& object, const std::string& name) const {
  const Hdf5Handle attribute(H5Aopen_by_name(file_.get(), object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
  std::int64_t value = 0;
  if (attribute.get() < 0 || H5Aread(attribute.get(), H5T_NATIVE_INT64, &value) < 0)
    throw_unreadable(path_, "the attribute " + name + " of " + object + " is missing");
  return value;
}

int Hdf5Reader::components(const std::string& name) const {
  const Hdf5Handle column = open_column(file_.get(), path_, name);
  const auto shape = shape_of(column.get());
  if (shape.size() != 2 || shape[1] < 1 || shape[1] > max_columns) throw_unreadable(path_, name + " is not a table");
  return static_cast<int>(shape[1]);
}

}  // namespace supple::files
