// SPDX-License-Identifier: GPL-3.0-or-later
// The reading functions of h5.h. A missing object is a valid answer, but any failure of HDF5 to answer is an
// error: a result without the unreadable part would look like that of another file.
#include <algorithm>
#include <span>

#include "base/core/error.h"
#include "base/memory/available_memory.h"
#include "base/text/file_path.h"
#include "base/text/json_text.h"
#include "store/hdf5/chunk_check.h"
#include "store/hdf5/guard/file_screening.h"
#include "store/hdf5/h5.h"
#include "store/hdf5/memory_file.h"

namespace landfall::h5 {
namespace {

constexpr double kHdf5Cache = 0x1p20;
/// The bytes of a dataset that HDF5 may hold, so that it decodes each chunk once for all parts that are read.
constexpr double kLargestCache = 0x1p29;
/// Smaller chunks are decoded again for each part of them.
constexpr double kSmallChunk = 0x1p22;

bool is_number(hid_t type) {
  const H5T_class_t type_class = H5Tget_class(type);
  return type_class == H5T_INTEGER || type_class == H5T_FLOAT;
}

bool has_values(hid_t space, std::size_t count) {
  return H5Sget_simple_extent_npoints(space) == static_cast<hssize_t>(count);
}

std::string file_of(hid_t object) { return name_text(object, H5Fget_name); }

std::string path_of(hid_t object) { return name_text(object, H5Iget_name); }

std::string path_in(hid_t parent, const std::string& name) {
  const std::string path = path_of(parent);
  return path + (path.ends_with("/") ? "" : "/") + name;
}

/// An empty handle if the object does not exist or is of another kind.
Handle open_kind(hid_t parent, const std::string& name, H5I_type_t kind) {
  if (!exists(parent, name)) return {};
  Handle object(H5Oopen(parent, name.c_str(), H5P_DEFAULT), H5Oclose);
  if (!object) fail_reading(parent, name);
  return H5Iget_type(object.get()) == kind ? std::move(object) : Handle();
}

/// The attribute; an empty handle if the object has none of this name. Throws FormatError if HDF5 fails.
Handle open_attribute(hid_t object, const std::string& name) {
  const htri_t found = H5Aexists(object, name.c_str());
  if (found == 0) return {};
  Handle attribute(found > 0 ? H5Aopen(object, name.c_str(), H5P_DEFAULT) : H5I_INVALID_HID, H5Aclose);
  if (!attribute) fail_reading_attribute(object, name);
  return attribute;
}

/// Reads the numbers if there are exactly `values.size()` of them; else returns false.
bool read_numbers(hid_t object, const std::string& name, std::span<double> values) {
  const Handle attribute = open_attribute(object, name);
  if (!attribute) return false;
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose);
  if (!is_number(type.get()) || !has_values(space.get(), values.size())) return false;
  if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, values.data()) < 0) fail_reading_attribute(object, name);
  return true;
}

/// Reads one text from an attribute or dataset through `read(type, buffer)`, which throws on failure; fixed
/// and variable lengths both occur. Returns nothing unless it is one text. Other programs may write text that
/// is not UTF-8.
template <class Read>
std::optional<std::string> read_string(hid_t file_type, hid_t space, const Read& read) {
  if (H5Tget_class(file_type) != H5T_STRING || !has_values(space, 1)) return std::nullopt;
  if (H5Tis_variable_str(file_type) > 0) {
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.get(), H5T_VARIABLE);
    H5Tset_cset(type.get(), H5Tget_cset(file_type));
    char* text = nullptr;
    read(type.get(), static_cast<void*>(&text));
    if (text == nullptr) return std::nullopt;
    const std::string result = text;
    H5free_memory(text);
    return as_utf8(result);
  }
  std::string result(H5Tget_size(file_type), '\0');
  read(file_type, static_cast<void*>(result.data()));
  result.resize(std::min(result.size(), result.find('\0')));
  return as_utf8(result);
}

}  // namespace

std::string name_text(hid_t object, ssize_t (*get)(hid_t, char*, std::size_t)) {
  const ssize_t length = get(object, nullptr, 0);
  std::string text(static_cast<std::size_t>(std::max<ssize_t>(length, 0)), '\0');
  if (length > 0) get(object, text.data(), text.size() + 1);
  return text;
}

Handle open_file(const std::filesystem::path& path) {
  if (const MemoryFile* const file = MemoryFile::find(path)) return file->open();
  require_regular_file(path);
  require_headroom(kHeadroom);
  MetadataGuard guard(path);
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id >= 0) {
    Handle file(id, H5Fclose);
    screen_file(id, path.string(), guard);
    return file;
  }
  const std::string reason = system_reason();
  if (!reason.empty()) throw FormatError(path.string() + ": reading failed: " + reason);
  if (H5Fis_hdf5(path.c_str()) <= 0) throw FormatError(path.string() + ": is not an HDF5 file");
  throw FormatError(path.string() + kNotWhole);
}

Handle open_for_its_kind(const std::filesystem::path& path) {
  require_headroom(kHeadroom);
  const MetadataGuard guard(path);
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file) return file;
  const std::string reason = system_reason();
  if (!reason.empty()) throw FormatError(path.string() + ": reading failed: " + reason);
  return {};
}

bool exists(hid_t parent, const std::string& name) {
  if (name == "/") return true;
  std::size_t end = 0;
  do {  // HDF5 reports a failure for a path whose beginning is missing
    end = name.find('/', end + 1);
    const std::string part = name.substr(0, end);
    if (part.empty() || part == "." || part == "/") return false;
    const htri_t found = H5Lexists(parent, part.c_str(), H5P_DEFAULT);
    if (found < 0) fail_reading(parent, part);
    if (found == 0) return false;
  } while (end != std::string::npos);
  return true;
}

Handle open_dataset(hid_t parent, const std::string& name) {
  Handle dataset = open_kind(parent, name, H5I_DATASET);
  if (!dataset || MemoryFile::of(dataset.get()) != nullptr) return dataset;
  const double row = chunk_bytes_of(dataset.get()).row;
  if (row <= kHdf5Cache || row > kLargestCache) return dataset;
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access.get(), H5D_CHUNK_CACHE_NSLOTS_DEFAULT, static_cast<std::size_t>(row),
                     H5D_CHUNK_CACHE_W0_DEFAULT);
  dataset.reset();  // the size holds for the first opening
  dataset = Handle(H5Dopen2(parent, name.c_str(), access.get()), H5Dclose);
  if (!dataset) fail_reading(parent, name);
  return dataset;
}

Handle open_group(hid_t parent, const std::string& name) { return open_kind(parent, name, H5I_GROUP); }

std::uint64_t stored_bytes(hid_t dataset) {
  if (const auto array = array_in_memory(dataset)) return array->values.size();
  H5Eclear2(H5E_DEFAULT);
  const hsize_t size = H5Dget_storage_size(dataset);
  if (size == 0 && H5Eget_num(H5E_DEFAULT) > 0) fail_reading(dataset);  // 0 means no data or a failure
  return size;
}

void fail_reading(hid_t object, const std::string& name) {
  const std::string reason = reading_failure();  // before the next call replaces it
  throw FormatError(file_of(object) + ": " + (name.empty() ? path_of(object) : path_in(object, name)) +
                    " cannot be read: " + reason);
}

void fail_reading_attribute(hid_t object, const std::string& name) {
  const std::string reason = reading_failure();
  throw FormatError(file_of(object) + ": the attribute " + name + " of " + path_of(object) +
                    " cannot be read: " + reason);
}

std::optional<std::string> read_text_attribute(hid_t object, const std::string& name) {
  const Handle attribute = open_attribute(object, name);
  if (!attribute) return std::nullopt;
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose);
  return read_string(type.get(), space.get(), [&](hid_t t, void* buffer) {
    if (H5Aread(attribute.get(), t, buffer) < 0) fail_reading_attribute(object, name);
  });
}

std::optional<double> read_number_attribute(hid_t object, const std::string& name) {
  double value = 0;
  if (!read_numbers(object, name, std::span(&value, 1))) return std::nullopt;
  return value;
}

std::optional<std::array<double, 2>> read_pair_attribute(hid_t object, const std::string& name) {
  std::array<double, 2> values{};
  if (!read_numbers(object, name, values)) return std::nullopt;
  return values;
}

std::vector<int> read_flags_attribute(hid_t object, const std::string& name) {
  constexpr hssize_t kMax = 256;  // number of values of an int8
  const Handle attribute = open_attribute(object, name);
  if (!attribute) return {};
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  if (!is_number(type.get()) || count < 1 || count > kMax) return {};
  std::vector<int> flags(static_cast<std::size_t>(count));
  if (H5Aread(attribute.get(), H5T_NATIVE_INT, flags.data()) < 0) fail_reading_attribute(object, name);
  return flags;
}

std::optional<std::string> read_text(hid_t parent, const std::string& name) {
  const Handle dataset = open_dataset(parent, name);
  if (!dataset) return std::nullopt;
  const Handle properties(H5Dget_create_plist(dataset.get()), H5Pclose);
  if (H5Pget_layout(properties.get()) == H5D_CHUNKED) return std::nullopt;
  const Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const Handle space(H5Dget_space(dataset.get()), H5Sclose);
  return read_string(type.get(), space.get(), [&](hid_t t, void* buffer) {
    if (H5Dread(dataset.get(), t, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer) < 0) fail_reading(parent, name);
  });
}

bool read_values(hid_t dataset, hid_t type, hid_t memory, hid_t selection, void* values) {
  if (const auto array = array_in_memory(dataset)) return gather(*array, type, selection, values);
  const ChunkBytes chunks = chunk_bytes_of(dataset);
  if (const std::optional<std::string> filter = undecodable_filter(dataset))
    throw FormatError(file_of(dataset) + ": " + path_of(dataset) + " is stored by filter " + *filter +
                      ", which landfall does not read: store it with deflate (h5repack -f GZIP=1)");
  if (selection != H5S_ALL && chunks.one > kSmallChunk && chunks.row > kLargestCache)
    throw FormatError(
        file_of(dataset) + ": " + path_of(dataset) +
        ": its chunks side by side have more than 512 MiB, too many to read parts of them; store it "
        "in smaller ones (h5repack)");
  return chunks_are_whole(dataset, selection) &&
         H5Dread(dataset, type, memory, selection, H5P_DEFAULT, values) >= 0;
}

bool read_block(hid_t dataset, hid_t type, std::span<const hsize_t> start, std::span<const hsize_t> count,
                void* values) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const Handle memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose);
  return H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) >=
             0 &&
         read_values(dataset, type, memory.get(), space.get(), values);
}

bool read_values(hid_t dataset, hid_t type, void* values) {
  return read_values(dataset, type, H5S_ALL, H5S_ALL, values);
}

}  // namespace landfall::h5
