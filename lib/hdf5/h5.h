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

/// Owns an HDF5 identifier and closes it by the function of its kind.
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
  /// Closes now; false where HDF5 reports a failure (a failed flush, for one).
  bool reset() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 || closer_(id) >= 0;
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Closer closer_ = nullptr;
};

/// Silences HDF5's own printing and lets no file have filter plug-ins loaded; call before any other use.
/// Reasons reach the user through failure_reason(). Throws std::bad_alloc where memory is short.
void initialise();
/// HDF5 is not reentrant. Where threads may meet in it (the readers and writers of a pipeline), each call is
/// made under this lock, and nothing long is done meanwhile.
[[nodiscard]] std::mutex& library_lock();
/// The innermost reason on HDF5's error stack ("No space left on device"), empty where there is none.
[[nodiscard]] std::string failure_reason();
/// What the system said of the last failure, empty where that was none of its.
[[nodiscard]] std::string system_reason();
/// Why data could not be read: what the system said, else that they are damaged.
[[nodiscard]] std::string reading_failure();

/// HDF5 1.10 crashes if it cannot have what it needs for its own start, for an open file or for a chunk.
inline constexpr std::size_t kHeadroom = std::size_t{8} << 20U;

/// The in-memory and on-disk type of a value. Only what every reader opens: no unsigned types
/// (docs/user/files/README.md).
enum class Type { float64, float32, int64, int32, int8 };
[[nodiscard]] hid_t native(Type type);
[[nodiscard]] std::size_t size_of(Type type);
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

/// The descriptor of the file that holds the object, while that is open; none where addresses within the file
/// are no offsets of the descriptor (another driver than H5FD_SEC2, a user block).
[[nodiscard]] std::optional<int> descriptor(hid_t object);
/// Has the system begin to write what it still holds of the file, without waiting for it: a long run's output
/// is then nearly on the disk when it is complete. Does nothing where the system has no such call.
void start_writeback(int descriptor);

/// Every creation below leaves out object times, so that equal content gives equal bytes. Each throws IoError
/// naming `object` when HDF5 refuses.
/// Closing the file closes every object in it; handles that remain are void.
Handle create_file(const std::filesystem::path& path);
Handle create_group(hid_t parent, const std::string& name);
/// Chunked (chunk dimensions > 0) with shuffle + deflate at `level` (0: no filter), or contiguous where
/// `chunk` is empty.
struct DatasetShape {
  std::vector<hsize_t> size;
  std::vector<hsize_t> chunk;
  bool growing = false;  ///< the first dimension is unlimited
  int level = 0;
  bool nan_fill = false;  ///< floating-point types only
};
Handle create_dataset(hid_t parent, const std::string& name, Type type, const DatasetShape& shape);
/// Writes a whole chunk as it is to be stored; `offset` is its first element. False where HDF5 refuses;
/// throws std::bad_alloc where memory is short.
[[nodiscard]] bool write_chunk(hid_t dataset, std::span<const hsize_t> offset,
                               std::span<const std::byte> bytes);

void write_attribute(hid_t object, const std::string& name, const std::string& text);
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, std::int64_t value);
void write_attribute(hid_t object, const std::string& name, const std::vector<std::int8_t>& values);
void write_attribute(hid_t object, const std::string& name, const std::array<double, 2>& values);
/// A scalar variable-length UTF-8 dataset with units and `long_name`: JSON goes here, for attributes end at
/// 64 KiB.
struct TextDataset {
  std::string name;
  std::string long_name;
};
void write_text(hid_t parent, const TextDataset& dataset, const std::string& text);

/// Opens a file to read. Throws FormatError: missing file, not HDF5, truncated, or what screen_file()
/// (file_screening.h) refuses, such as links to other files.
Handle open_file(const std::filesystem::path& path);
/// A file that is not screened, for a look at the attributes of its root and nothing else; none where it is
/// no HDF5 file. Throws FormatError where the system does not let that be seen.
[[nodiscard]] Handle open_for_its_kind(const std::filesystem::path& path);

/// What follows answers "nothing" only where there is nothing of that name, or something of another kind (a
/// number where a text is wanted, two values where one is). Each throws FormatError, naming file and object,
/// where that cannot be told or read. Of a text, bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] bool exists(hid_t parent, const std::string& name);
[[nodiscard]] Handle open_dataset(hid_t parent, const std::string& name);
[[nodiscard]] Handle open_group(hid_t parent, const std::string& name);
[[nodiscard]] std::optional<std::string> read_text_attribute(hid_t object, const std::string& name);
[[nodiscard]] std::optional<double> read_number_attribute(hid_t object, const std::string& name);
[[nodiscard]] std::optional<std::array<double, 2>> read_pair_attribute(hid_t object, const std::string& name);
/// 1 to 256 integers; else none.
[[nodiscard]] std::vector<int> read_flags_attribute(hid_t object, const std::string& name);
/// Of a dataset in one piece; of one in chunks nothing.
[[nodiscard]] std::optional<std::string> read_text(hid_t parent, const std::string& name);

/// H5Dread() of the values that `selection`, of the dataset's space, holds (H5S_ALL: of all) into those of
/// `memory`, once each chunk that it touches is known to be whole (chunk_check.h). False where HDF5 fails or
/// a chunk is damaged; reading_failure() tells why. Throws FormatError for a filter whose chunks cannot be
/// looked at.
[[nodiscard]] bool read_values(hid_t dataset, hid_t type, hid_t memory, hid_t selection, void* values);
[[nodiscard]] bool read_values(hid_t dataset, hid_t type, void* values);
/// The bytes that the values of a dataset take in the file; 0 where none is stored.
[[nodiscard]] std::uint64_t stored_bytes(hid_t dataset);
/// Throws FormatError for the object `name` in `object` (without a name: for the object itself) or for an
/// attribute, after HDF5's last call on it has failed.
[[noreturn]] void fail_reading(hid_t object, const std::string& name = "");
[[noreturn]] void fail_reading_attribute(hid_t object, const std::string& name);

}  // namespace landfall::h5
