// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D465
#include "store/hdf5/memory_file.h"

#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <mutex>
#include <new>
#include <numeric>
#include <utility>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "store/hdf5/chunk_codec.h"
#include "store/hdf5/h5_filters.h"

namespace landfall::h5 {
namespace {

/// The files of this process by name. `any` spares all others the search.
struct Register {
  std::mutex lock;
  std::map<std::string, MemoryFile*> files;
  std::atomic<bool> any = false;
};

Register& known_files() {
  static Register files;
  return files;
}

/// HDF5's driver `core`, which never writes to a disk.
Handle access_in_memory() {
  constexpr std::size_t kStep = std::size_t{1} << 16U;
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), kStep, false);
  return access;
}

std::vector<hsize_t> memory_chunk_of(hid_t dataset) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  std::vector<hsize_t> chunk(H5S_MAX_RANK, 0);
  const int rank = H5Pget_chunk(properties.get(), H5S_MAX_RANK, chunk.data());
  chunk.resize(static_cast<std::size_t>(std::max(rank, 0)));
  return chunk;
}

std::size_t element_count(std::span<const hsize_t> numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), std::size_t{1}, std::multiplies<>());
}

/// Uninitialised values of the type and extent of a dataset or attribute; null for a type that no tool
/// writes.
std::shared_ptr<MemoryArray> room_for(const Handle& type, const Handle& space) {
  const auto plain = type_of(type.get());
  if (!plain) return nullptr;
  auto array = std::make_shared<MemoryArray>();
  array->type = *plain;
  array->shape = extent_of(space.get());
  array->values.resize(element_count(array->shape) * size_of(*plain));
  return array;
}

std::shared_ptr<MemoryArray> room_for(hid_t dataset) {
  return room_for(Handle(H5Dget_type(dataset), H5Tclose), Handle(H5Dget_space(dataset), H5Sclose));
}

/// A chunk and its array as rows of bytes: a dataset of one dimension is one row.
struct Rows {
  std::size_t chunk_row = 0, array_row = 0;  ///< bytes
  std::size_t count = 0, copied = 0;         ///< rows, and bytes of each
  std::size_t begin = 0;                     ///< of the first row in the array
};

Rows rows_of(const MemoryArray& array, std::span<const hsize_t> chunk, std::span<const hsize_t> offset) {
  const std::size_t size = size_of(array.type);
  const auto left = [&](std::size_t d) { return std::min(chunk[d], array.shape[d] - offset[d]); };
  const std::size_t last = array.shape.size() - 1;
  const bool is_plane = last == 1;
  return {.chunk_row = chunk[last] * size,
          .array_row = array.shape[last] * size,
          .count = is_plane ? left(0) : 1,
          .copied = left(last) * size,
          .begin = ((is_plane ? offset[0] * array.shape[1] : 0) + offset[last]) * size};
}

/// The chunk of an array in plain form, with zeros beyond the array.
void take_chunk(const MemoryArray& array, std::span<const hsize_t> chunk, std::span<const hsize_t> offset,
                std::vector<std::byte>& bytes) {
  bytes.assign(element_count(chunk) * size_of(array.type), std::byte{0});
  const Rows rows = rows_of(array, chunk, offset);
  for (std::size_t r = 0; r < rows.count; ++r)
    std::memcpy(bytes.data() + r * rows.chunk_row, array.values.data() + rows.begin + r * rows.array_row,
                rows.copied);
}

/// The first elements of all chunks, in order.
std::vector<std::vector<hsize_t>> offsets_of(std::span<const hsize_t> shape, std::span<const hsize_t> chunk) {
  std::vector<std::vector<hsize_t>> offsets = {{}};
  for (std::size_t d = 0; d < shape.size(); ++d) {
    std::vector<std::vector<hsize_t>> longer;
    for (const std::vector<hsize_t>& offset : offsets)
      for (hsize_t at = 0; at < shape[d]; at += chunk[d]) {
        longer.push_back(offset);
        longer.back().push_back(at);
      }
    offsets = std::move(longer);
  }
  return offsets;
}

void save_array(hid_t file, const std::string& path, const MemoryArray& array) {
  const Handle dataset = open_dataset(file, path);
  const std::vector<hsize_t> chunk = memory_chunk_of(dataset.get());
  const auto offsets = offsets_of(array.shape, chunk);
  struct Slot {
    ChunkEncoder encoder;
    std::vector<std::byte> plain{};
    std::span<const std::byte> stored{};
  };
  std::vector<Slot> slots(4 * thread_count(),
                          Slot{ChunkEncoder(size_of(array.type), deflate_level(dataset.get()).value_or(0))});
  produce_in_parallel(
      offsets.size(), slots.size(),
      [&](std::size_t i, std::size_t number) {
        Slot& slot = slots[number];
        take_chunk(array, chunk, offsets[i], slot.plain);
        slot.stored = slot.encoder.encode(slot.plain);
      },
      [&](std::size_t i, std::size_t number) {
        const std::lock_guard lock(library_lock());
        if (!write_chunk(dataset.get(), offsets[i], slots[number].stored))
          throw IoError("writing " + path + " failed: " + failure_reason());
      });
}

}  // namespace

GrowingBytes::~GrowingBytes() {
  if (data_ != nullptr) LargeAllocator<std::byte>().deallocate(data_, capacity_);
}

void GrowingBytes::resize(std::size_t size) {
  if (size > capacity_) grow(size);
  size_ = size;
}

/// The pages of a large block are moved to another one, whose alignment keeps huge pages whole. realloc()
/// would copy the bytes or split the pages, which took longer than a scan.
void GrowingBytes::grow(std::size_t size) {
  std::size_t capacity = std::max(size, 2 * capacity_);  // pages that are not used cost nothing
  if (capacity >= kLargeBlock) capacity = (capacity + kHugePage - 1) / kHugePage * kHugePage;
  std::byte* const larger = LargeAllocator<std::byte>().allocate(capacity);
  if (capacity_ >= kLargeBlock) {
    if (mremap(data_, capacity_, capacity, MREMAP_MAYMOVE | MREMAP_FIXED, larger) == MAP_FAILED)
      throw std::bad_alloc();
  } else if (data_ != nullptr) {
    std::memcpy(larger, data_, size_);
    LargeAllocator<std::byte>().deallocate(data_, capacity_);
  }
  data_ = larger;
  capacity_ = capacity;
}

MemoryFile::MemoryFile(std::string name) : name_(std::move(name)) {
  Register& known = known_files();
  const std::lock_guard lock(known.lock);
  if (std::filesystem::exists(name_) || !known.files.emplace(name_, this).second)
    throw UsageError(name_ + " exists; a file in memory needs another name");
  known.any = true;
}

MemoryFile::~MemoryFile() {
  Register& known = known_files();
  const std::lock_guard lock(known.lock);
  known.files.erase(name_);
  known.any = !known.files.empty();
}

MemoryFile* MemoryFile::find(const std::filesystem::path& name) {
  Register& known = known_files();
  if (!known.any) return nullptr;
  const std::lock_guard lock(known.lock);
  const auto found = known.files.find(name.string());
  return found == known.files.end() ? nullptr : found->second;
}

MemoryFile* MemoryFile::of(hid_t object) {
  return known_files().any ? find(name_text(object, H5Fget_name)) : nullptr;
}

Handle MemoryFile::create(hid_t creation_properties) {
  arrays_.clear();
  todo_.clear();
  file_.reset();
  const Handle access = access_in_memory();
  file_ = Handle(H5Fcreate(name_.c_str(), H5F_ACC_TRUNC, creation_properties, access.get()), H5Fclose);
  if (!file_) throw IoError(name_ + " cannot be made: " + failure_reason());
  return open();
}

void MemoryFile::load(const std::filesystem::path& path) {
  const Handle checked = open_file(path);
  const Handle access = access_in_memory();
  arrays_.clear();
  todo_.clear();
  file_ = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!file_) throw FormatError(path.string() + ": reading failed: " + reading_failure());
}

Handle MemoryFile::open() const {
  Handle again(file_ ? H5Freopen(file_.get()) : H5I_INVALID_HID, H5Fclose);
  if (!again) throw FormatError(name_ + ": has no content");
  return again;
}

std::shared_ptr<const MemoryArray> MemoryFile::array(const std::string& path) const {
  const auto found = arrays_.find(path);
  return found == arrays_.end() ? nullptr : found->second;
}

std::vector<MemoryFile::Member> MemoryFile::members(const std::string& group) const {
  const Handle root = open();
  const Handle opened = open_group(root.get(), group);
  std::vector<Member> found;
  const auto add = [](hid_t parent, const char* name, const H5L_info_t* /*info*/, void* target) -> herr_t {
    const Handle object(H5Oopen(parent, name, H5P_DEFAULT), H5Oclose);
    static_cast<decltype(found)*>(target)->push_back({name, H5Iget_type(object.get()) == H5I_GROUP});
    return 0;
  };
  hsize_t place = 0;
  if (opened) H5Literate(opened.get(), H5_INDEX_CRT_ORDER, H5_ITER_INC, &place, add, &found);
  return found;
}

std::map<std::string, MemoryFile::Content> MemoryFile::attributes(const std::string& path) const {
  const Handle root = open();
  const Handle object(H5Oopen(root.get(), path.c_str(), H5P_DEFAULT), H5Oclose);
  std::vector<std::string> names;
  const auto add = [](hid_t /*owner*/, const char* name, const H5A_info_t* /*info*/, void* target) -> herr_t {
    static_cast<decltype(names)*>(target)->emplace_back(name);
    return 0;
  };
  hsize_t place = 0;
  if (object) H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_INC, &place, add, &names);
  std::map<std::string, Content> found;
  for (const std::string& name : names) {
    const Handle attribute(H5Aopen(object.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
    const auto values = room_for(Handle(H5Aget_type(attribute.get()), H5Tclose),
                                 Handle(H5Aget_space(attribute.get()), H5Sclose));
    if (values && H5Aread(attribute.get(), native(values->type), values->values.data()) >= 0)
      found.emplace(name, values);
    else if (const auto text = read_text_attribute(object.get(), name))
      found.emplace(name, *text);
  }
  return found;
}

MemoryFile::Content MemoryFile::values(const std::string& path) const {
  if (auto held = array(path)) return held;
  const Handle root = open();
  const Handle dataset = open_dataset(root.get(), path);
  if (!dataset) throw FormatError(name_ + ": has no dataset " + path);
  if (auto text = read_text(root.get(), path)) return *std::move(text);
  const std::shared_ptr<MemoryArray> array = room_for(dataset.get());
  if (!array) throw FormatError(name_ + ": " + path + " has a type that no tool writes");
  if (array->values.size() > 0 && !read_values(dataset.get(), native(array->type), array->values.data()))
    fail_reading(dataset.get());
  return array;
}

void MemoryFile::put_chunk(hid_t dataset, std::span<const hsize_t> offset, std::span<const std::byte> bytes) {
  std::shared_ptr<MemoryArray>& array = arrays_[name_text(dataset, H5Iget_name)];
  if (!array) array = room_for(dataset);
  if (!array) throw std::logic_error("a dataset in memory of a type that no tool writes");
  array->shape = extent_of(Handle(H5Dget_space(dataset), H5Sclose).get());
  array->values.resize(element_count(array->shape) * size_of(array->type));
  const Rows rows = rows_of(*array, memory_chunk_of(dataset), offset);
  for (std::size_t r = 0; r < rows.count; ++r)
    std::memcpy(array->values.data() + rows.begin + r * rows.array_row, bytes.data() + r * rows.chunk_row,
                rows.copied);
}

std::shared_ptr<const MemoryArray> array_in_memory(hid_t dataset) {
  const MemoryFile* const file = MemoryFile::of(dataset);
  return file == nullptr ? nullptr : file->array(name_text(dataset, H5Iget_name));
}

bool gather(const MemoryArray& array, hid_t type, hid_t selection, void* values) {
  const auto rank = static_cast<int>(array.shape.size());
  const Handle all(H5Screate_simple(rank, array.shape.data(), nullptr), H5Sclose);
  const hid_t space = selection == H5S_ALL ? all.get() : selection;
  const auto count = static_cast<std::size_t>(std::max<hssize_t>(H5Sget_select_npoints(space), 0));
  if (count == 0) return true;
  const hid_t stored = native(array.type);
  const std::size_t wanted_size = count * H5Tget_size(type);
  const std::size_t stored_size = count * size_of(array.type);
  std::vector<std::byte, LargeAllocator<std::byte>> larger(stored_size > wanted_size ? stored_size : 0);
  void* const target = larger.empty() ? values : larger.data();
  if (H5Dgather(space, array.values.data(), stored, stored_size, target, nullptr, nullptr) < 0 ||
      H5Tconvert(stored, type, count, target, nullptr, H5P_DEFAULT) < 0)
    return false;
  if (!larger.empty()) std::memcpy(values, larger.data(), wanted_size);
  return true;
}

void MemoryFile::when_saved(std::function<void(hid_t)> work) { todo_.push_back(std::move(work)); }

void for_other_programs(hid_t root, const std::function<void(hid_t)>& work) {
  if (MemoryFile* const file = MemoryFile::of(root))
    file->when_saved(work);
  else
    work(root);
}

std::string MemoryFile::image() {
  const std::lock_guard lock(saving_);
  const Handle file = open();
  for (const auto& work : todo_) work(file.get());
  todo_.clear();
  H5Fflush(file.get(), H5F_SCOPE_GLOBAL);
  std::string bytes(static_cast<std::size_t>(std::max<ssize_t>(H5Fget_file_image(file.get(), nullptr, 0), 0)),
                    '\0');
  if (H5Fget_file_image(file.get(), bytes.data(), bytes.size()) < 0)
    throw IoError(name_ + " cannot be copied: " + failure_reason());
  return bytes;
}

void MemoryFile::save_arrays(const std::filesystem::path& path) const {
  Handle saved(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  if (!saved) throw IoError(path.string() + " cannot be written: " + failure_reason());
  for (const auto& [name, array] : arrays_) save_array(saved.get(), name, *array);
  if (const auto failure = close_file(saved)) throw IoError(path.string() + ": closing failed: " + *failure);
}

}  // namespace landfall::h5
