// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "store/hdf5/guard/message_check.h"
#include "store/hdf5/guard/object_header.h"
#include "store/hdf5/guard/raw_file.h"

namespace landfall::h5 {

/// The part of a file from `begin` to before `end`.
struct ByteRange {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
};

/// Checks the metadata of an HDF5 file that libhdf5 1.10 uses without a check of its own, and that have no
/// checksum: with damaged ones it crashes, does not end or takes gigabytes of memory. These are the
/// superblock, object headers of version 1 with their messages, groups stored as symbol tables, B-trees of
/// chunks, and the heaps that hold values of variable length, for scalar and one-dimensional attributes and
/// datasets without chunks. Not checked, because they have checksums: the fractal heaps and B-trees of newer
/// groups.
///
/// Uses no function of HDF5. Memory and time are those of the metadata.
class MetadataCheck {
 public:
  /// `file` must live as long as this.
  explicit MetadataCheck(const RawFile& file);

  /// False for a file whose addresses are not offsets in 64 bits: it is not checked at all.
  [[nodiscard]] bool applies() const { return root_.has_value(); }
  /// The end of HDF5's contents; behind it, other programs may have appended something.
  [[nodiscard]] std::uint64_t end() const { return end_; }
  /// Address of the root group's header. Throws Damaged if it is not in the file.
  [[nodiscard]] std::uint64_t root() const { return *root_; }
  /// Checks the object whose header is at `address`, once.
  void check_object(std::uint64_t address);
  /// The chunks of the datasets that were checked, in order of their addresses; neighbours are joined.
  [[nodiscard]] std::vector<ByteRange> chunks() const;

 private:
  struct Dataset;

  [[nodiscard]] std::optional<std::uint64_t> read_superblock();
  void check_message(const HeaderMessage& message, Dataset& dataset);
  void check_dataset(const Dataset& dataset);
  void check_group(std::span<const std::byte> body);
  [[nodiscard]] std::vector<std::byte> local_heap(std::uint64_t address) const;
  void check_group_node(std::uint64_t address, const std::vector<std::byte>& names, int level);
  void check_symbols(std::uint64_t address, const std::vector<std::byte>& names);
  void check_chunk_node(std::uint64_t address, const Dataset& dataset, int level);
  void check_values(std::span<const std::byte> values, std::uint64_t count, const StoredType& type);
  /// Sizes of the objects of a global heap, by index.
  const std::map<std::uint64_t, std::uint64_t>& global_heap(std::uint64_t address);

  const RawFile& file_;
  std::uint64_t leaf_k_ = 4;    ///< half the entries of a symbol node
  std::uint64_t group_k_ = 16;  ///< half the children of a node of groups
  std::uint64_t chunk_k_ = 32;
  std::uint64_t end_ = file_.size();
  std::optional<std::uint64_t> root_;
  std::set<std::uint64_t> objects_;
  std::set<std::uint64_t> nodes_;
  std::map<std::uint64_t, std::map<std::uint64_t, std::uint64_t>> heaps_;
  std::vector<ByteRange> chunks_;
};

}  // namespace landfall::h5
