// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 metadata are checked before libhdf5 reads them. With one flipped bit in them, libhdf5 1.10 crashes,
// hangs or allocates gigabytes: it does not check that an index is in a heap, that a B-tree has no cycle,
// that a chunk is as large as its entry says, or that a message fits in its header. landfall walks through
// the superblock, object headers, groups, B-trees and heaps of a file itself, without the library, and
// refuses the file where they contradict each other or the file's size. It checks each object when the
// screening (lib/store/hdf5/guard/file_screening.h) arrives at it. Newer structures (fractal heaps, version 2
// B-trees) have checksums, which libhdf5 compares.
#include "store/hdf5/guard/metadata_check.h"

#include <algorithm>

namespace landfall::h5 {
namespace {

/// A chunk is hardly larger than its values: deflate adds 5 bytes per 16 KiB to what it cannot compress.
constexpr std::uint64_t kMaxExpansion = 2;
constexpr std::uint64_t kFilterBytes = 4096;
constexpr std::uint64_t kMaxK = 4096;
constexpr std::uint64_t kMaxHeapBytes = std::uint64_t{256} << 20U;
constexpr std::uint64_t kNodeHead = 24;
constexpr int kMaxLevel = 32;

struct NodeHead {
  int level;
  std::uint64_t count;
};

/// Reads the head of a B-tree node and leaves the cursor at its first key.
NodeHead node_head(ByteCursor& cursor, const RawFile& file, std::uint64_t type, std::uint64_t k, int level) {
  cursor.expect("TREE");
  require_sound(cursor.number(1) == type);
  const NodeHead head{static_cast<int>(cursor.number(1)), cursor.number(2)};
  require_sound(head.count <= 2 * k && head.level <= kMaxLevel && (level < 0 || head.level == level));
  for (int i = 0; i < 2; ++i) {
    const std::uint64_t sibling = cursor.number(8);
    require_sound(sibling == kNoAddress || sibling < file.size());
  }
  return head;
}

}  // namespace

/// The dataset whose header is being checked.
struct MetadataCheck::Dataset {
  std::optional<StoredType> type;
  std::optional<std::vector<std::uint64_t>> space;
  std::optional<StoredLayout> layout;
  std::optional<std::uint64_t> fill_size;
  bool is_filtered = false;
  std::uint64_t ratio = 1;  ///< check_filters()
};

MetadataCheck::MetadataCheck(const RawFile& file) : file_(file), root_(read_superblock()) {}

std::optional<std::uint64_t> MetadataCheck::read_superblock() {
  constexpr std::uint64_t kLongest = 96;
  const std::vector<std::byte> bytes = file_.read(0, std::min(file_.size(), kLongest));
  ByteCursor cursor(bytes);
  cursor.expect("\x89HDF\r\n\x1a\n");
  const std::uint64_t version = cursor.number(1);
  if (version == 2 || version == 3) {
    if (cursor.number(1) != 8 || cursor.number(1) != 8) return std::nullopt;
    cursor.skip(1);
    if (cursor.number(8) != 0) return std::nullopt;
    cursor.skip(8);
    end_ = cursor.number(8);
    return cursor.number(8);
  }
  require_sound(version <= 1);
  cursor.skip(4);
  if (cursor.number(1) != 8 || cursor.number(1) != 8) return std::nullopt;
  cursor.skip(1);
  leaf_k_ = cursor.number(2);
  group_k_ = cursor.number(2);
  cursor.skip(4);
  if (version == 1) {
    chunk_k_ = cursor.number(2);
    cursor.skip(2);
  }
  require_sound(leaf_k_ > 0 && group_k_ > 0 && chunk_k_ > 0 &&
                std::max({leaf_k_, group_k_, chunk_k_}) <= kMaxK);
  if (cursor.number(8) != 0) return std::nullopt;
  const std::uint64_t free_space = cursor.number(8);
  end_ = cursor.number(8);
  const std::uint64_t driver = cursor.number(8);
  for (const std::uint64_t address : {free_space, end_, driver})
    require_sound(address == kNoAddress || address <= file_.size());
  cursor.skip(8);
  const std::uint64_t root = cursor.number(8);
  const std::uint64_t cache = cursor.number(4);
  cursor.skip(4);
  require_sound(cache == 0 ||
                (cache == 1 && cursor.number(8) < file_.size() && cursor.number(8) < file_.size()));
  return root;
}

void MetadataCheck::check_object(std::uint64_t address) {
  if (!objects_.insert(address).second) return;
  Dataset dataset;
  for (const HeaderMessage& message : messages_at(file_, address)) {
    if (!message.shared) check_message(message, dataset);
  }
  check_dataset(dataset);
}

void MetadataCheck::check_message(const HeaderMessage& message, Dataset& dataset) {
  const std::span<const std::byte> body = message.body;
  switch (message.type) {
    case MessageType::dataspace:
      dataset.space = check_dataspace(body);
      break;
    case MessageType::datatype:
      dataset.type = check_datatype(body);
      break;
    case MessageType::old_fill_value: {
      ByteCursor cursor(body);
      cursor.skip(cursor.number(4));
      break;
    }
    case MessageType::fill_value:
      dataset.fill_size = check_fill_value(body);
      break;
    case MessageType::link_info:
      check_storage(body, 8, file_.size());
      break;
    case MessageType::attribute_info:
      check_storage(body, 2, file_.size());
      break;
    case MessageType::link:
      check_link(body, file_.size());
      break;
    case MessageType::layout:
      dataset.layout = check_layout(body);
      break;
    case MessageType::filters:
      dataset.is_filtered = true;
      dataset.ratio = check_filters(body);
      break;
    case MessageType::attribute:
      if (const auto attribute = check_attribute(body))
        check_values(attribute->values, attribute->count, attribute->type);
      break;
    case MessageType::symbol_table:
      check_group(body);
      break;
    default:
      break;
  }
}

void MetadataCheck::check_dataset(const Dataset& dataset) {
  if (!dataset.layout || !dataset.type) return;
  const StoredLayout& layout = *dataset.layout;
  require_sound(dataset.fill_size.value_or(0) == 0 || *dataset.fill_size == dataset.type->size);
  const std::uint64_t count = dataset.space ? checked_product(*dataset.space) : 0;
  const std::uint64_t size = checked_product({count, dataset.type->size});
  if (layout.kind == StoredLayout::Kind::chunked) {
    require_sound(dataset.space && layout.chunk.size() == dataset.space->size() + 1);
    require_sound(layout.chunk.back() == dataset.type->size && checked_product(layout.chunk) > 0);
    if (layout.address != kNoAddress) check_chunk_node(layout.address, dataset, -1);
    return;
  }
  if (layout.kind == StoredLayout::Kind::compact) {
    require_sound(layout.values.size() >= size);
    check_values(layout.values, count, *dataset.type);
  }
  if (layout.kind != StoredLayout::Kind::contiguous || layout.address == kNoAddress) return;
  require_sound(file_.holds(layout.address, layout.size) && layout.size >= size);
  if (dataset.type->in_heap) check_values(file_.read(layout.address, size), count, *dataset.type);
}

void MetadataCheck::check_chunk_node(std::uint64_t address, const Dataset& dataset, int level) {
  const std::vector<std::uint64_t>& chunk = dataset.layout->chunk;
  const std::uint64_t key_size = 8 + 8 * chunk.size();
  const std::uint64_t chunk_bytes = checked_product(chunk);
  const std::uint64_t max_bytes = kMaxExpansion * chunk_bytes + kFilterBytes;
  require_sound(nodes_.insert(address).second);
  const auto bytes = file_.read(address, kNodeHead + (2 * chunk_k_ + 1) * key_size + 2 * chunk_k_ * 8);
  ByteCursor cursor(bytes);
  const NodeHead head = node_head(cursor, file_, 1, chunk_k_, level);
  std::vector<std::uint64_t> previous;
  for (std::uint64_t i = 0; i < head.count; ++i) {
    const std::uint64_t size = cursor.number(4);
    cursor.skip(4);
    std::vector<std::uint64_t> offset(chunk.size());
    for (std::size_t axis = 0; axis < chunk.size(); ++axis) {
      offset[axis] = cursor.number(8);
      require_sound(offset[axis] % chunk[axis] == 0);
    }
    require_sound(previous < offset && offset.back() == 0);
    previous = std::move(offset);
    const std::uint64_t child = cursor.number(8);
    if (head.level > 0) {
      check_chunk_node(child, dataset, head.level - 1);
    } else {
      require_sound(size > 0 && size <= max_bytes && file_.holds(child, size));
      require_sound(dataset.is_filtered || size == chunk_bytes);  // else it is read beyond its memory
      require_sound(dataset.ratio == 0 || chunk_bytes / dataset.ratio <= size);
      chunks_.push_back({child, child + size});
    }
  }
}

void MetadataCheck::check_group(std::span<const std::byte> body) {
  ByteCursor cursor(body);
  const std::uint64_t tree = cursor.number(8);
  const std::vector<std::byte> names = local_heap(cursor.number(8));
  check_group_node(tree, names, -1);
}

std::vector<std::byte> MetadataCheck::local_heap(std::uint64_t address) const {
  constexpr std::uint64_t kNoFreeBlock = 1;
  const std::vector<std::byte> head = file_.read(address, 32);
  ByteCursor cursor(head);
  cursor.expect("HEAP");
  require_sound(cursor.number(4) == 0);
  const std::uint64_t size = cursor.number(8);
  std::uint64_t free = cursor.number(8);
  require_sound(size <= kMaxHeapBytes);
  std::vector<std::byte> segment = file_.read(cursor.number(8), size);
  for (std::uint64_t blocks = 0; free != kNoFreeBlock; ++blocks) {
    require_sound(blocks <= size / 16 && free <= size);
    ByteCursor block(std::span<const std::byte>(segment).subspan(free));
    const std::uint64_t next = block.number(8);
    const std::uint64_t block_size = block.number(8);
    require_sound(block_size >= 16 && block_size <= size - free);
    free = next;
  }
  return segment;
}

void MetadataCheck::check_group_node(std::uint64_t address, const std::vector<std::byte>& names, int level) {
  require_sound(nodes_.insert(address).second);
  const auto bytes = file_.read(address, kNodeHead + (2 * group_k_ + 1) * 8 + 2 * group_k_ * 8);
  ByteCursor cursor(bytes);
  const NodeHead head = node_head(cursor, file_, 0, group_k_, level);
  for (std::uint64_t i = 0; i < head.count; ++i) {
    require_sound(cursor.number(8) < names.size());
    const std::uint64_t child = cursor.number(8);
    if (head.level > 0)
      check_group_node(child, names, head.level - 1);
    else
      check_symbols(child, names);
  }
  require_sound(head.count == 0 || cursor.number(8) < names.size());
}

void MetadataCheck::check_symbols(std::uint64_t address, const std::vector<std::byte>& names) {
  constexpr std::uint64_t kEntry = 40;
  require_sound(nodes_.insert(address).second);
  const auto bytes = file_.read(address, 8 + 2 * leaf_k_ * kEntry);
  ByteCursor cursor(bytes);
  cursor.expect("SNOD");
  require_sound(cursor.number(1) == 1);
  cursor.skip(1);
  const std::uint64_t count = cursor.number(2);
  require_sound(count <= 2 * leaf_k_);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t name = cursor.number(8);
    require_sound(name < names.size());
    require_sound(std::find(names.begin() + static_cast<std::ptrdiff_t>(name), names.end(), std::byte{0}) !=
                  names.end());
    const std::uint64_t object = cursor.number(8);
    const std::uint64_t cache = cursor.number(4);
    cursor.skip(4);
    require_sound(cache <= 2 && (cache == 2 || object < file_.size()));
    if (cache == 1) {
      require_sound(cursor.number(8) < file_.size() && cursor.number(8) < file_.size());
    } else {
      require_sound(cursor.number(4) < names.size() || cache == 0);
      cursor.skip(12);
    }
  }
}

void MetadataCheck::check_values(std::span<const std::byte> values, std::uint64_t count,
                                 const StoredType& type) {
  if (!type.in_heap) return;
  ByteCursor cursor(values);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t length = cursor.number(4);
    const std::uint64_t heap = cursor.number(8);
    const std::uint64_t index = cursor.number(4);
    if (heap == 0 || length == 0) continue;  // no value
    const auto& sizes = global_heap(heap);
    const auto found = sizes.find(index);
    require_sound(found != sizes.end() && checked_product({length, type.base_size}) <= found->second);
  }
}

const std::map<std::uint64_t, std::uint64_t>& MetadataCheck::global_heap(std::uint64_t address) {
  constexpr std::uint64_t kSmallest = 4096;
  constexpr std::uint64_t kObjectHead = 16;
  const auto [heap, is_new] = heaps_.try_emplace(address);
  if (!is_new) return heap->second;
  const std::vector<std::byte> head = file_.read(address, 16);
  ByteCursor start(head);
  start.expect("GCOL");
  require_sound(start.number(1) == 1);
  start.skip(3);
  const std::uint64_t size = start.number(8);
  require_sound(size >= kSmallest && size <= kMaxHeapBytes);
  const std::vector<std::byte> bytes = file_.read(address, size);
  ByteCursor cursor(bytes);
  cursor.skip(kObjectHead);
  while (cursor.left() >= kObjectHead) {
    const std::uint64_t index = cursor.number(2);
    cursor.skip(6);
    const std::uint64_t object = cursor.number(8);
    if (index == 0) {  // free space; its size includes the head
      require_sound(object >= kObjectHead);
      cursor.skip(object - kObjectHead);
      continue;
    }
    require_sound(heap->second.emplace(index, object).second && object <= size);
    cursor.skip((object + 7) / 8 * 8);
  }
  return heap->second;
}

std::vector<ByteRange> MetadataCheck::chunks() const {
  std::vector<ByteRange> sorted = chunks_;
  std::ranges::sort(sorted, {}, &ByteRange::begin);
  std::vector<ByteRange> joined;
  for (const ByteRange& range : sorted) {
    if (!joined.empty() && range.begin <= joined.back().end)
      joined.back().end = std::max(joined.back().end, range.end);
    else
      joined.push_back(range);
  }
  return joined;
}

}  // namespace landfall::h5
