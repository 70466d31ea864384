// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace landfall::h5 {

/// Owns an HDF5 identifier and closes it by the function for its kind.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), closer_(other.closer_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(closer_, other.closer_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  [[nodiscard]] hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }
  /// Closes now; false if HDF5 reports a failure (for example a failed flush).
  bool reset() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 || closer_(id) >= 0;
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Closer closer_ = nullptr;
};

/// Disables HDF5's own error output and the loading of filter plug-ins; call before any other use.
/// failure_reason() gives the reasons for the user. Throws std::bad_alloc if memory is short.
void initialise();
/// Whether HDF5 has a lock of its own, so that two runs of one process may use it at the same time.
[[nodiscard]] bool is_built_for_threads();
/// HDF5 is not reentrant. Where several threads may call it (the readers and writers of a pipeline), each
/// call is made under this lock, and no long work is done while it is held.
[[nodiscard]] std::mutex& library_lock();
/// The innermost reason on HDF5's error stack ("No space left on device"); empty if there is none.
[[nodiscard]] std::string failure_reason();
/// The system's reason for the last failure; empty if the system reported none.
[[nodiscard]] std::string system_reason();
/// Why data could not be read: the system's reason, else that they are damaged.
[[nodiscard]] std::string reading_failure();

/// HDF5 1.10 crashes if it cannot allocate what it needs for its own start, for an open file or for a chunk.
inline constexpr std::size_t kHeadroom = std::size_t{8} << 20U;

/// The in-memory and on-disk type of a value. Only types that every reader opens: no unsigned types
/// (docs/user/files/README.md).
enum class Type { float64, float32, int64, int32, int8 };
[[nodiscard]] hid_t native(Type type);
[[nodiscard]] std::size_t size_of(Type type);
/// The type of these values; nothing for one that no tool writes, such as a text.
[[nodiscard]] std::optional<Type> type_of(hid_t datatype);
/// The extent of a dataset or attribute; empty for a scalar.
[[nodiscard]] std::vector<hsize_t> extent_of(hid_t dataspace);
template <class T>
struct TypeOf;
template <>
struct TypeOf<double> {
  static constexpr Type value = Type::float64;
};
template <>
struct TypeOf<float> {
  static constexpr Type value = Type::float32;
};
template <>
struct TypeOf<std::int64_t> {
  static constexpr Type value = Type::int64;
};
template <>
struct TypeOf<std::int32_t> {
  static constexpr Type value = Type::int32;
};
template <>
struct TypeOf<std::int8_t> {
  static constexpr Type value = Type::int8;
};

/// The descriptor of the file that holds the object, valid while that is open. Returns nothing if addresses
/// within the file are not offsets of the descriptor (another driver than H5FD_SEC2, a user block).
[[nodiscard]] std::optional<int> descriptor(hid_t object);
/// Asks the system to start writing its buffers of the file without waiting for it: a long run's output is
/// then nearly on the disk when it is complete. Does nothing if the system has no such call.
void start_writeback(int descriptor);

/// The level of chunks that stay in plain form: those of a MemoryFile (memory_file.h), which compresses them
/// at level 1 when it is saved.
inline constexpr int kPlain = -1;

/// Every creation below leaves out object times, so that equal content gives equal bytes. Each throws IoError
/// naming `object` when HDF5 refuses. Closing the file closes every object in it; remaining handles become
/// invalid.
/// The file is in memory if `path` is the name of a MemoryFile.
Handle create_file(const std::filesystem::path& path);
Handle create_group(hid_t parent, const std::string& name);
/// Chunked (chunk dimensions > 0) with shuffle and deflate at `level` (0: only with deflate, for its
/// checksum; ChunkEncoder), or contiguous if `chunk` is empty.
struct DatasetShape {
  std::vector<hsize_t> size;
  std::vector<hsize_t> chunk;
  bool growing = false;  ///< the first dimension is unlimited
  int level = 0;
  bool nan_fill = false;  ///< floating-point types only
};
Handle create_dataset(hid_t parent, const std::string& name, Type type, const DatasetShape& shape);
/// Writes a whole chunk in its stored form; `offset` is its first element. Returns false if HDF5 refuses;
/// throws std::bad_alloc if memory is short.
[[nodiscard]] bool write_chunk(hid_t dataset, std::span<const hsize_t> offset,
                               std::span<const std::byte> bytes);

/// Texts have a fixed length: HDF5 keeps those of variable length in heaps, which have no checksum. An
/// attribute is limited to 64 KiB.
void write_attribute(hid_t object, const std::string& name, const std::string& text);
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, std::int64_t value);
void write_attribute(hid_t object, const std::string& name, const std::vector<std::int8_t>& values);
/// Two numbers of `type`, which must be able to hold them.
void write_attribute(hid_t object, const std::string& name, Type type, const std::array<double, 2>& values);
/// A scalar UTF-8 dataset with units and `long_name`. Used for JSON, which may be larger than an attribute.
struct TextDataset {
  std::string name;
  std::string long_name;
};
void write_text(hid_t parent, const TextDataset& dataset, const std::string& text);

/// The name that HDF5 gives an object by H5Fget_name or H5Iget_name; empty if it gives none.
[[nodiscard]] std::string name_text(hid_t object, ssize_t (*get)(hid_t, char*, std::size_t));

/// Opens a file for reading. Throws FormatError if it is missing, not HDF5, truncated, or refused by
/// screen_file() (file_screening.h), for example because of links to other files. A MemoryFile is opened as
/// it is.
Handle open_file(const std::filesystem::path& path);
/// Opens a file without screening it, only to read the attributes of its root; an empty handle if it is not
/// an HDF5 file. Throws FormatError if the system refuses access or the file is damaged.
[[nodiscard]] Handle open_for_its_kind(const std::filesystem::path& path);

/// The functions below return "nothing" only if no object has that name, or if it is of another kind (a
/// number instead of a text, two values instead of one). Each throws FormatError, naming file and object, if
/// that cannot be determined or read. In a text, bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] bool exists(hid_t parent, const std::string& name);
[[nodiscard]] Handle open_dataset(hid_t parent, const std::string& name);
[[nodiscard]] Handle open_group(hid_t parent, const std::string& name);
[[nodiscard]] std::optional<std::string> read_text_attribute(hid_t object, const std::string& name);
[[nodiscard]] std::optional<double> read_number_attribute(hid_t object, const std::string& name);
[[nodiscard]] std::optional<std::array<double, 2>> read_pair_attribute(hid_t object, const std::string& name);
/// 1 to 256 integers; an empty list for anything else.
[[nodiscard]] std::vector<int> read_flags_attribute(hid_t object, const std::string& name);
/// Reads a contiguous text dataset; returns nothing for a chunked one.
[[nodiscard]] std::optional<std::string> read_text(hid_t parent, const std::string& name);

/// H5Dread() of the values that `selection` of the dataset's space holds (H5S_ALL: all) into those of
/// `memory`, after each chunk that it touches is known to be whole (chunk_check.h). False if HDF5 fails or a
/// chunk is damaged; reading_failure() gives the reason. Throws FormatError for a filter whose chunks cannot
/// be checked.
[[nodiscard]] bool read_values(hid_t dataset, hid_t type, hid_t memory, hid_t selection, void* values);
[[nodiscard]] bool read_values(hid_t dataset, hid_t type, void* values);
/// The same of the block of `count` values along each dimension from `start` on.
[[nodiscard]] bool read_block(hid_t dataset, hid_t type, std::span<const hsize_t> start,
                              std::span<const hsize_t> count, void* values);
/// The bytes that the values of a dataset occupy in the file; 0 if none is stored.
[[nodiscard]] std::uint64_t stored_bytes(hid_t dataset);
/// Throws FormatError for the object `name` in `object` (without a name: for the object itself) or for an
/// attribute. Call it after HDF5's last call on that object has failed.
[[noreturn]] void fail_reading(hid_t object, const std::string& name = "");
[[noreturn]] void fail_reading_attribute(hid_t object, const std::string& name);

/// Flushes and closes a file that was written. Returns the reason for a failure, or nothing if all data is on
/// its way to the disk. Also reports a dataset made by create_dataset() or write_text() in this process that
/// could not be closed: HDF5 writes small or cached data only on closing, and a Handle that goes out of scope
/// cannot report a failure.
[[nodiscard]] std::optional<std::string> close_file(Handle& file);

}  // namespace landfall::h5
