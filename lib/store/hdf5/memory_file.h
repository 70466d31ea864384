// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/memory/large_memory.h"
#include "store/hdf5/h5.h"

namespace landfall::h5 {

/// Bytes that are not initialised and grow without a copy: the system moves the pages of a large block.
class GrowingBytes {
 public:
  GrowingBytes() = default;
  ~GrowingBytes();
  GrowingBytes(const GrowingBytes&) = delete;
  GrowingBytes& operator=(const GrowingBytes&) = delete;

  /// Keeps the bytes up to the smaller size. Throws std::bad_alloc.
  void resize(std::size_t size);
  [[nodiscard]] std::byte* data() { return data_; }
  [[nodiscard]] const std::byte* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void grow(std::size_t size);

  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

/// The values of a dataset in memory: one block, in the order of the last index.
struct MemoryArray {
  Type type = Type::float64;
  std::vector<hsize_t> shape{};
  GrowingBytes values{};
};

/// A file that exists in this process only, while the object lives, so that tools pass results to each other
/// without a disk. create_file() makes it and open_file() opens it by its name, which no file on the disk may
/// have. HDF5 holds its attributes, texts and axes; the values of chunked datasets are MemoryArrays, in plain
/// form: the chunks of write_chunk() and create_dataset()'s filters apply only to save_arrays().
class MemoryFile {
 public:
  /// Throws UsageError if the name is that of another MemoryFile or of a file on the disk.
  explicit MemoryFile(std::string name);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  /// The file of this name; null if there is none.
  [[nodiscard]] static MemoryFile* find(const std::filesystem::path& name);
  /// The file that holds the object; null if that is on a disk.
  [[nodiscard]] static MemoryFile* of(hid_t object);

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Makes the file, empty, and returns an identifier for its writer. Throws IoError.
  Handle create(hid_t creation_properties);
  /// Takes the content of a file on a disk: HDF5 holds it as it is stored, so that it is checked and read
  /// from the disk once. Throws as open_file().
  void load(const std::filesystem::path& path);
  /// Another identifier of the file. Throws FormatError if it was not created.
  [[nodiscard]] Handle open() const;

  /// The values of the dataset at a path such as "/points/x_est"; null if it has none here: HDF5 then holds
  /// its values. Whoever keeps them may outlive the file.
  [[nodiscard]] std::shared_ptr<const MemoryArray> array(const std::string& path) const;
  struct Member {
    std::string name;
    bool is_group = false;
  };
  /// The members of a group, as they were created.
  [[nodiscard]] std::vector<Member> members(const std::string& group) const;
  /// A text, or values.
  using Content = std::variant<std::string, std::shared_ptr<const MemoryArray>>;
  /// The attributes of an object by name, without references; a scalar has an empty shape.
  [[nodiscard]] std::map<std::string, Content> attributes(const std::string& path) const;
  /// A dataset. Throws FormatError if there is none of this path.
  [[nodiscard]] Content values(const std::string& path) const;
  /// Takes a chunk in plain form, with which write_chunk() was called; its part beyond the dataset's extent
  /// is left out.
  void put_chunk(hid_t dataset, std::span<const hsize_t> offset, std::span<const std::byte> bytes);
  /// Keeps work on the file, which gets its root, for image().
  void when_saved(std::function<void(hid_t root)> work);
  /// The bytes of a file on a disk with all but the values of arrays. Throws IoError.
  [[nodiscard]] std::string image();
  /// Writes the values of the arrays to the file at `path`, which holds image(), with its chunks filtered as
  /// their datasets say. Throws IoError.
  void save_arrays(const std::filesystem::path& path) const;

 private:
  std::string name_;
  Handle file_{};
  std::map<std::string, std::shared_ptr<MemoryArray>> arrays_;
  std::vector<std::function<void(hid_t)>> todo_;  ///< by image()
  std::mutex saving_;
};

/// Work on a file that serves other programs only, such as dimensions of netCDF: done now, or when a
/// MemoryFile is saved.
void for_other_programs(hid_t root, const std::function<void(hid_t root)>& work);

/// The values of a dataset of a MemoryFile that has them as an array; else null.
[[nodiscard]] std::shared_ptr<const MemoryArray> array_in_memory(hid_t dataset);
/// As read_values(); false if HDF5 fails.
[[nodiscard]] bool gather(const MemoryArray& array, hid_t type, hid_t selection, void* values);

}  // namespace landfall::h5
