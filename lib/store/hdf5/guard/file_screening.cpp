// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/guard/file_screening.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "base/text/json_text.h"
#include "base/text/shown_text.h"
#include "store/hdf5/chunk_codec.h"
#include "store/hdf5/guard/file_seal.h"
#include "store/hdf5/guard/scale_check.h"
#include "store/hdf5/h5.h"
#include "store/hdf5/h5_filters.h"

// An object that does not exist is a normal result; one that cannot be read is an error. If HDF5 cannot
// determine whether a name exists, the run ends. A value of another type or shape than expected (a number
// instead of a text) counts as missing, because other programs may write it. An object whose header cannot
// be read ends the run even if it is not needed, because it cannot be screened (below).
//
// HDF5 files are self-contained. A link that is not hard, a virtual dataset, and values stored in another
// file are refused wherever they are, even if nothing would read them, and no option allows them: a file's
// id identifies one file, and landfall's own files contain no links. When a file is opened, all of it is
// screened once, so that no reader can omit the check; the screening opens no other file and reads no
// values. Soft links stay within the file, but readers differed in following them.
//
// Claimed size of a dataset. 256 MiB, which costs little, or the size that deflate could have compressed
// (1032 : 1) to the stored bytes. Chunks have at most 256 MiB, like blocks of rasters
// (lib/formats/gdal/reader.cpp): common writers use less than 10.

namespace landfall::h5 {
namespace {

bool is_hdf5(const RawFile& file) {
  constexpr std::array<unsigned char, 8> kSignature = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
  if (file.size() < kSignature.size()) return false;
  const std::vector<std::byte> start = file.read(0, kSignature.size());
  return std::ranges::equal(start, std::as_bytes(std::span(kSignature)));
}

constexpr double kMebi = 0x1p20;
constexpr double kMaxChunkBytes = 256 * kMebi;
constexpr double kMaxUnstoredBytes = 256 * kMebi;
constexpr std::size_t kMaxObjects = std::size_t{1} << 20U;
/// HDF5 uses about 2 KiB of memory for each chunk that it reads.
constexpr double kMaxSmallChunks = 0x1p16;
constexpr double kSmallChunkBytes = 2048;
constexpr const char* kAdvice =
    "; landfall does not open files named by other files: copy the data into one file";

struct Link {
  std::string name;
  H5L_type_t type;
  haddr_t address;  ///< of a hard link's object
};

herr_t add_link(hid_t /*group*/, const char* name, const H5L_info_t* info, void* links) {
  static_cast<std::vector<Link>*>(links)->push_back({name, info->type, info->u.address});
  return 0;
}

struct Group {
  haddr_t address;
  std::string path;  ///< ends with "/"
};

/// The target of a soft or external link; empty if it cannot be read.
std::vector<char> link_value(hid_t group, const std::string& name) {
  H5L_info_t info;
  if (H5Lget_info(group, name.c_str(), &info, H5P_DEFAULT) < 0) return {};
  std::vector<char> value(info.u.val_size + 1, '\0');
  if (H5Lget_val(group, name.c_str(), value.data(), info.u.val_size, H5P_DEFAULT) < 0) return {};
  return value;
}

std::string soft_target(hid_t group, const std::string& name) {
  const std::vector<char> value = link_value(group, name);
  return value.empty() ? "?" : value.data();
}

std::string external_target(hid_t group, const std::string& name) {
  const std::vector<char> value = link_value(group, name);
  unsigned flags = 0;
  const char* file = nullptr;
  const char* path = nullptr;
  if (value.empty() || H5Lunpack_elink_val(value.data(), value.size() - 1, &flags, &file, &path) < 0)
    return "?";
  return std::string(file) + ":" + path;
}

std::string first_virtual_source(hid_t properties) {
  std::array<char, 4096> file{};
  if (H5Pget_virtual_filename(properties, 0, file.data(), file.size() - 1) < 0) return "?";
  return file.data();
}

std::string first_external_file(hid_t properties) {
  std::array<char, 4096> file{};
  off_t offset = 0;
  hsize_t size = 0;
  if (H5Pget_external(properties, 0, file.size() - 1, file.data(), &offset, &size) < 0) return "?";
  return file.data();
}

double value_bytes(hid_t dataset) {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  return static_cast<double>(H5Tget_size(type.get()));
}

/// Elements per dimension; 1 for dimensions that do not exist.
using Extent = std::array<double, H5S_MAX_RANK>;

Extent as_extent(int rank, const std::array<hsize_t, H5S_MAX_RANK>& size) {
  Extent extent;
  extent.fill(1);
  std::copy_n(size.begin(), std::max(rank, 0), extent.begin());
  return extent;
}

Extent size_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  std::array<hsize_t, H5S_MAX_RANK> size{};
  return as_extent(H5Sget_simple_extent_dims(space.get(), size.data(), nullptr), size);
}

/// Returns nothing if a dataset has no chunks.
std::optional<Extent> chunk_of(hid_t properties) {
  std::array<hsize_t, H5S_MAX_RANK> size{};
  if (H5Pget_layout(properties) != H5D_CHUNKED) return std::nullopt;
  return as_extent(H5Pget_chunk(properties, H5S_MAX_RANK, size.data()), size);
}

double product(const Extent& extent) {
  return std::accumulate(extent.begin(), extent.end(), 1.0, std::multiplies<>());
}

double chunk_count(const Extent& size, const Extent& chunk) {
  double count = 1;
  for (std::size_t axis = 0; axis < size.size(); ++axis) count *= std::ceil(size[axis] / chunk[axis]);
  return count;
}

class Screening {
 public:
  Screening(const std::string& name, MetadataGuard& guard) : name_(name), guard_(guard) {}

  void screen(hid_t file) {
    H5O_info_t root;
    if (H5Oget_info2(file, &root, H5O_INFO_BASIC) < 0) fail("/ cannot be read: " + reading_failure());
    add_group({root.addr, "/"});
    while (!groups_.empty()) {
      const Group next = std::move(groups_.back());
      groups_.pop_back();
      screen_group(file, next);
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw FormatError(name_ + ": " + what); }

  /// True for an object that no earlier link led to.
  bool is_new(haddr_t address) {
    if (seen_.size() == kMaxObjects) fail("holds more than 2^20 objects");
    return seen_.insert(address).second;
  }

  void add_group(Group group) {
    if (is_new(group.address)) groups_.push_back(std::move(group));
  }

  void screen_group(hid_t file, const Group& where) {
    const Handle group(H5Oopen_by_addr(file, where.address), H5Oclose);
    std::vector<Link> links;
    if (H5Literate(group.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, add_link, &links) < 0)
      fail("the group " + where.path + " cannot be listed: " + reading_failure());
    for (const Link& link : links) {
      const std::string path = where.path + link.name;
      if (!is_utf8(link.name))
        fail(where.path + " holds an object whose name, '" + shown_word(link.name) + "', is not UTF-8");
      if (link.type != H5L_TYPE_HARD) refuse_link(group.get(), link, path);
      guard_.check(link.address, path);
      screen_object(group.get(), link.name, path);
    }
  }

  [[noreturn]] void refuse_link(hid_t group, const Link& link, const std::string& path) const {
    if (link.type == H5L_TYPE_EXTERNAL)
      fail(path + " is a link to another file, " + external_target(group, link.name) + kAdvice);
    if (link.type == H5L_TYPE_SOFT)
      fail(path + " is a soft link, to " + soft_target(group, link.name) +
           "; landfall does not follow links: replace the link by the object");
    fail(path + " is a user-defined link; landfall does not follow links: replace the link by the object");
  }

  void screen_object(hid_t group, const std::string& name, const std::string& path) {
    H5O_info_t info;
    if (H5Oget_info_by_name2(group, name.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) < 0)
      fail(path + " cannot be read: " + reading_failure());
    if (info.type == H5O_TYPE_GROUP) add_group({info.addr, path + "/"});
    if (info.type != H5O_TYPE_DATASET || !is_new(info.addr)) return;
    const Handle dataset(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset) fail(path + " cannot be read: " + reading_failure());
    const Handle properties(H5Dget_create_plist(dataset.get()), H5Pclose);
    screen_storage(properties.get(), path);
    screen_filters(properties.get(), path);
    screen_sizes(dataset.get(), properties.get(), path);
    if (const std::optional<std::string> fault = scale_fault(dataset.get()))
      fail(path + ": its attribute " + *fault + ", as HDF5's dimension scales need it; delete or correct it");
  }

  void screen_storage(hid_t properties, const std::string& path) const {
    if (H5Pget_layout(properties) == H5D_VIRTUAL)
      fail(path + " is a virtual dataset, of " + first_virtual_source(properties) + kAdvice);
    if (H5Pget_external_count(properties) > 0)
      fail(path + " stores its values in another file, " + first_external_file(properties) + kAdvice);
  }

  void screen_filters(hid_t properties, const std::string& path) const {
    for (const Filter& filter : filters_in(properties))
      if (filter.id >= 0 && H5Zfilter_avail(filter.id) <= 0)
        fail(path + " is stored by filter " + text_of(filter) +
             ", which is not one of HDF5's own filters; landfall does not load plug-ins: store it with "
             "deflate");
  }

  void screen_sizes(hid_t dataset, hid_t properties, const std::string& path) const {
    const double bytes = value_bytes(dataset);
    const Extent size = size_of(dataset);
    const std::optional<Extent> chunk = chunk_of(properties);
    const double chunk_bytes = chunk ? bytes * product(*chunk) : 0;
    if (chunk_bytes > kMaxChunkBytes)
      fail(path + " is stored in chunks of " + std::to_string(std::int64_t(chunk_bytes / kMebi)) +
           " MiB, more than 256; store it in smaller ones");
    const auto stored = static_cast<double>(stored_bytes(dataset));
    if (bytes * product(size) > std::max(kMaxUnstoredBytes, stored * kMaxDeflate))
      fail(path + " declares more values than the " + std::to_string(std::int64_t(stored)) +
           " bytes stored for it can hold; it is damaged or truncated");
    if (chunk && chunk_bytes < kSmallChunkBytes && chunk_count(size, *chunk) > kMaxSmallChunks)
      fail(path + " is stored in more than 2^16 chunks of less than 2 KiB; store it in larger ones");
  }

  const std::string& name_;
  MetadataGuard& guard_;
  std::vector<Group> groups_;  ///< not yet visited
  std::set<haddr_t> seen_;
};

}  // namespace

MetadataGuard::MetadataGuard(const std::filesystem::path& path) : name_(path.string()), file_(path) {
  try {
    if (!is_hdf5(file_)) return;
    check_.emplace(file_);
    require_sound(seal_of(file_, check_->end()) != Seal::broken);
    if (check_->applies())
      check_->check_object(check_->root());
    else
      check_.reset();
  } catch (const Damaged&) {
    throw FormatError(name_ + kNotWhole);
  }
}

void MetadataGuard::check(std::uint64_t address, const std::string& path) {
  try {
    if (check_) check_->check_object(address);
  } catch (const Damaged&) {
    throw FormatError(name_ + ": " + path + " cannot be read: it is damaged");
  }
}

void screen_file(hid_t file, const std::string& name, MetadataGuard& guard) {
  Screening(name, guard).screen(file);
}

}  // namespace landfall::h5
