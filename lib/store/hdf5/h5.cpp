// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/h5.h"

#include <fcntl.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "base/core/error.h"
#include "base/memory/available_memory.h"
#include "store/hdf5/memory_file.h"

// Members of a group are kept in the order of their creation, in which netCDF, and so GMT and GDAL's
// netCDF driver, list them: the first layer is the one that a user wants. GDAL's HDF5 driver (3.6) sorts
// by name. Links stay in the group's header, which has no further structure that could be damaged, and
// saves 1 to 3 kB per file.
//
// Texts have a fixed length. HDF5 stores texts of variable length in global heaps, which have no checksum
// and in which libhdf5 1.10 crashes if a bit is wrong; Octave cannot load them, and GMT does not show them
// as title and units. The disadvantage is that h5py gives bytes. Texts are declared as ASCII if they are,
// because Octave does not load UTF-8, and text datasets end with a zero, because netCDF reads up to it.
// Only the references between layers and their coordinates (`DIMENSION_LIST`) are still in heaps.

namespace landfall::h5 {
namespace {

Handle checked(hid_t id, Handle::Closer closer, const std::string& object) {
  if (id >= 0) return {id, closer};
  const std::string reason = failure_reason();
  throw IoError("writing " + object + " failed" + (reason.empty() ? "" : ": " + reason));
}

void require(bool ok, const std::string& object) {
  if (!ok) checked(H5I_INVALID_HID, nullptr, object);
}

/// A text of `size` bytes. Octave reads those that are declared as ASCII only.
Handle text_type(const std::string& text, std::size_t size, H5T_str_t padding) {
  const bool is_ascii =
      std::ranges::none_of(text, [](char c) { return static_cast<unsigned char>(c) > 127; });
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), size);
  H5Tset_strpad(type.get(), padding);
  H5Tset_cset(type.get(), is_ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8);
  return type;
}

Handle scalar_space() { return {H5Screate(H5S_SCALAR), H5Sclose}; }

Handle row_space(hsize_t size) { return {H5Screate_simple(1, &size, nullptr), H5Sclose}; }

/// Stores values of the type `given` as `stored`.
void write_attribute_in(const Handle& space, hid_t object, const std::string& name, hid_t stored, hid_t given,
                        const void* values) {
  const Handle attribute = checked(
      H5Acreate2(object, name.c_str(), stored, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
  require(H5Awrite(attribute.get(), given, values) >= 0, name);
}

void write_scalar_attribute(hid_t object, const std::string& name, hid_t type, const void* value) {
  write_attribute_in(scalar_space(), object, name, type, type, value);
}

/// Keeps the system's reason, because HDF5's own wording of it does not help a user.
herr_t keep_system_reason(unsigned /*depth*/, const H5E_error2_t* record, void* target) {
  const std::string text = record->desc == nullptr ? "" : record->desc;
  const std::size_t begin = text.find("error message = '");
  if (begin == std::string::npos) return 0;
  const std::size_t start = begin + 17;
  *static_cast<std::string*>(target) = text.substr(start, text.find('\'', start) - start);
  return 1;
}

herr_t keep_reason(unsigned depth, const H5E_error2_t* record, void* target) {
  auto& reason = *static_cast<std::string*>(target);
  if (reason.empty() && record->desc != nullptr) reason = record->desc;
  return keep_system_reason(depth, record, target);
}

std::string reason_by(H5E_walk2_t keep) {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep, &reason);
  return reason;
}

/// netCDF then lists a group's members as they were created, not by name: the first grid of GMT and of GDAL's
/// netCDF driver is the first layer that was written. Links stay in the group's header: a heap for more than
/// eight of them would take more space, and a damaged one would be another structure that HDF5 must survive.
void keep_creation_order(hid_t group_properties) {
  constexpr unsigned kMaxLinks = 65535;
  H5Pset_link_creation_order(group_properties, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  H5Pset_link_phase_change(group_properties, kMaxLinks, 0);
}

std::mutex close_lock;
std::string close_failure;  // NOLINT(*-avoid-non-const-global-variables)

/// H5Dclose whose first failure close_file() reports; closing an already closed object is not a failure.
herr_t close_written(hid_t dataset) {
  if (H5Iis_valid(dataset) <= 0) return -1;
  const herr_t result = H5Dclose(dataset);
  if (result >= 0) return result;
  const std::string reason = failure_reason();
  const std::lock_guard lock(close_lock);
  if (close_failure.empty()) close_failure = reason.empty() ? "HDF5 cannot close a dataset" : reason;
  return result;
}

}  // namespace

void initialise() {
  require_headroom(kHeadroom);
  // Every identifier has an owner that closes it. HDF5's own clean-up at exit would try again to flush a file
  // that a full disk refused, and crash (HDF5 1.10).
  H5dont_atexit();
  H5PLset_loading_state(0);  // otherwise a file's filters could load plug-ins
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

std::optional<std::string> close_file(Handle& file) {
  if (H5Fflush(file.get(), H5F_SCOPE_GLOBAL) < 0 || !file.reset()) return failure_reason();
  const std::lock_guard lock(close_lock);
  std::string failure = std::exchange(close_failure, "");
  return failure.empty() ? std::nullopt : std::optional(std::move(failure));
}

bool is_built_for_threads() {
  hbool_t has_lock = 0;
  return H5is_library_threadsafe(&has_lock) >= 0 && has_lock != 0;
}

std::mutex& library_lock() {
  static std::mutex lock;
  return lock;
}

std::string failure_reason() { return reason_by(keep_reason); }

std::string system_reason() { return reason_by(keep_system_reason); }

std::string reading_failure() {
  const std::string reason = system_reason();
  return reason.empty() ? "it is damaged" : reason;
}

hid_t native(Type type) {
  switch (type) {
    case Type::float64:
      return H5T_IEEE_F64LE;
    case Type::float32:
      return H5T_IEEE_F32LE;
    case Type::int64:
      return H5T_STD_I64LE;
    case Type::int32:
      return H5T_STD_I32LE;
    case Type::int8:
      return H5T_STD_I8LE;
  }
  return H5I_INVALID_HID;
}

std::optional<Type> type_of(hid_t datatype) {
  using enum Type;
  for (const Type candidate : {float64, float32, int64, int32, int8})
    if (H5Tequal(datatype, native(candidate)) > 0) return candidate;
  return std::nullopt;
}

std::vector<hsize_t> extent_of(hid_t dataspace) {
  std::vector<hsize_t> extent(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(dataspace), 0)));
  H5Sget_simple_extent_dims(dataspace, extent.data(), nullptr);
  return extent;
}

std::size_t size_of(Type type) {
  switch (type) {
    case Type::float64:
    case Type::int64:
      return 8;
    case Type::float32:
    case Type::int32:
      return 4;
    case Type::int8:
      return 1;
  }
  return 0;
}

Handle create_file(const std::filesystem::path& path) {
  require_headroom(kHeadroom);
  // H5F_CLOSE_STRONG: closing the file closes all objects that are still open in it. By default HDF5 would
  // delay the closing, report success, and write the rest after the file has been renamed.
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  keep_creation_order(creation.get());
  if (MemoryFile* const file = MemoryFile::find(path)) return file->create(creation.get());
  return checked(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose,
                 path.string());
}

std::optional<int> descriptor(hid_t object) {
  const Handle file(H5Iget_file_id(object), H5Fclose);
  const Handle access(H5Fget_access_plist(file.get()), H5Pclose);
  const Handle creation(H5Fget_create_plist(file.get()), H5Pclose);
  hsize_t user_block = 0;
  void* handle = nullptr;
  if (H5Pget_driver(access.get()) != H5FD_SEC2 || H5Pget_userblock(creation.get(), &user_block) < 0 ||
      user_block != 0 || H5Fget_vfd_handle(file.get(), access.get(), &handle) < 0 || handle == nullptr)
    return std::nullopt;
  return *static_cast<int*>(handle);
}

void start_writeback([[maybe_unused]] int descriptor) {
#ifdef SYNC_FILE_RANGE_WRITE
  static_cast<void>(::sync_file_range(descriptor, 0, 0, SYNC_FILE_RANGE_WRITE));
#endif
}

Handle create_group(hid_t parent, const std::string& name) {
  const Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  keep_creation_order(properties.get());
  return checked(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Gclose,
                 name);
}

Handle create_dataset(hid_t parent, const std::string& name, Type type, const DatasetShape& shape) {
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  const auto rank = static_cast<int>(shape.size.size());
  if (!shape.chunk.empty()) {
    H5Pset_chunk(properties.get(), rank, shape.chunk.data());
    H5Pset_fill_time(properties.get(), H5D_FILL_TIME_IFSET);
    const int level = shape.level == kPlain ? 1 : shape.level;
    if (level > 0) H5Pset_shuffle(properties.get());
    H5Pset_deflate(properties.get(), static_cast<unsigned>(level));
  }
  if (shape.nan_fill) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    H5Pset_fill_value(properties.get(), H5T_NATIVE_DOUBLE, &nan);
  }
  std::vector<hsize_t> largest = shape.size;
  if (shape.growing) largest.at(0) = H5S_UNLIMITED;
  const Handle space(
      rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, shape.size.data(), largest.data()),
      H5Sclose);
  return checked(
      H5Dcreate2(parent, name.c_str(), native(type), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      close_written, name);
}

bool write_chunk(hid_t dataset, std::span<const hsize_t> offset, std::span<const std::byte> bytes) {
  require_headroom(kHeadroom);
  if (MemoryFile* const file = MemoryFile::of(dataset)) {
    file->put_chunk(dataset, offset, bytes);
    return true;
  }
  return H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, offset.data(), bytes.size(), bytes.data()) >= 0;
}

void write_attribute(hid_t object, const std::string& name, const std::string& text) {
  const std::size_t size = std::max<std::size_t>(text.size(), 1);  // HDF5 has no text of size 0
  write_scalar_attribute(object, name, text_type(text, size, H5T_STR_NULLPAD).get(), text.c_str());
}

void write_attribute(hid_t object, const std::string& name, double value) {
  write_scalar_attribute(object, name, H5T_IEEE_F64LE, &value);
}

void write_attribute(hid_t object, const std::string& name, std::int64_t value) {
  write_scalar_attribute(object, name, H5T_STD_I64LE, &value);
}

void write_attribute(hid_t object, const std::string& name, const std::vector<std::int8_t>& values) {
  write_attribute_in(row_space(values.size()), object, name, H5T_STD_I8LE, H5T_STD_I8LE, values.data());
}

void write_attribute(hid_t object, const std::string& name, Type type, const std::array<double, 2>& values) {
  write_attribute_in(row_space(values.size()), object, name, native(type), H5T_NATIVE_DOUBLE, values.data());
}

void write_text(hid_t parent, const TextDataset& what, const std::string& text) {
  const std::string& name = what.name;
  const Handle type = text_type(text, text.size() + 1, H5T_STR_NULLTERM);  // netCDF reads up to the zero
  const Handle space = scalar_space();
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  const Handle dataset = checked(
      H5Dcreate2(parent, name.c_str(), type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      close_written, name);
  require(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) >= 0, name);
  write_attribute(dataset.get(), "units", std::string("1"));
  write_attribute(dataset.get(), "long_name", what.long_name);
}

}  // namespace landfall::h5
