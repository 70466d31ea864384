// SPDX-License-Identifier: GPL-3.0-or-later
// A seal at the end of each HDF5 file shows any changed byte of its metadata:
// lib/store/hdf5/guard/metadata_check.h finds what libhdf5 cannot read, but not a flipped bit in an origin or
// a configuration. It lies behind the end of the file that HDF5 knows, so that other programs do not see it
// and remove it when they change the file; a file without it is read. Chunks have checksums of their own
// (lib/store/hdf5/chunk_filters.h) and are left out, so that opening a file takes milliseconds. An attribute
// could not hold the hash, because it would have to be part of what is hashed.
#include "store/hdf5/guard/file_seal.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>

#include "base/core/error.h"
#include "base/core/hash.h"
#include "store/hdf5/guard/metadata_check.h"
#include "store/hdf5/h5.h"

namespace landfall::h5 {
namespace {

// The seal: the signature; for each range of chunks its begin and end; then the number of ranges, the size of
// the file before the seal, the hash and the signature again. Numbers are little-endian.
constexpr std::string_view kSignature = "landfall seal 1\n";
constexpr std::size_t kHashDigits = 32;
constexpr std::size_t kFooterBytes = 16 + kHashDigits + kSignature.size();
constexpr std::size_t kSealBytes = kSignature.size() + kFooterBytes;  ///< without ranges
constexpr std::size_t kRangeBytes = 16;

void put_number(std::vector<std::byte>& bytes, std::uint64_t value) {
  for (unsigned shift = 0; shift < 64; shift += 8)
    bytes.push_back(static_cast<std::byte>(value >> shift & 0xffU));
}

void put_text(std::vector<std::byte>& bytes, std::string_view text) {
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
}

/// The hash of the bytes before `size` that are in no range, and of `ranges` themselves.
std::string hash_of(const RawFile& file, const std::vector<ByteRange>& ranges, std::uint64_t size) {
  constexpr std::uint64_t kPiece = std::uint64_t{1} << 20U;
  Hash hash;
  std::vector<std::byte> numbers;
  put_number(numbers, size);
  std::uint64_t at = 0;
  const auto add_until = [&](std::uint64_t end) {
    for (; at < end; at += std::min(kPiece, end - at)) hash.update(file.read(at, std::min(kPiece, end - at)));
  };
  for (const ByteRange& range : ranges) {
    require_sound(at <= range.begin && range.begin <= range.end && range.end <= size);
    put_number(numbers, range.begin);
    put_number(numbers, range.end);
    add_until(range.begin);
    at = range.end;
  }
  add_until(size);
  return hash.update(numbers).hex();
}

std::vector<ByteRange> chunks_in(const RawFile& file, const std::vector<haddr_t>& objects) {
  MetadataCheck check(file);
  require_sound(check.applies());
  for (const haddr_t object : objects) check.check_object(object);
  return check.chunks();
}

std::vector<std::byte> seal_for(const RawFile& file, const std::vector<ByteRange>& ranges) {
  std::vector<std::byte> seal;
  put_text(seal, kSignature);
  for (const ByteRange& range : ranges) {
    put_number(seal, range.begin);
    put_number(seal, range.end);
  }
  put_number(seal, ranges.size());
  put_number(seal, file.size());
  put_text(seal, hash_of(file, ranges, file.size()));
  put_text(seal, kSignature);
  return seal;
}

/// Whether a seal, or as much of one as the file has, begins there.
bool begins_seal(const RawFile& file, std::uint64_t at) {
  if (at >= file.size()) return false;
  const std::vector<std::byte> bytes =
      file.read(at, std::min<std::uint64_t>(kSignature.size(), file.size() - at));
  return kSignature.starts_with({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void append(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  bool written = descriptor >= 0;
  for (std::size_t done = 0; written && done < bytes.size();) {
    const ssize_t count = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    written = count >= 0;
    done += static_cast<std::size_t>(std::max<ssize_t>(count, 0));
  }
  const int reason = errno;
  const bool closed = descriptor < 0 || ::close(descriptor) == 0;
  if (!written || !closed)
    throw IoError("closing failed: " + std::string(std::strerror(written ? errno : reason)));
}

herr_t add_address(hid_t /*root*/, const char* /*name*/, const H5O_info_t* info, void* list) {
  static_cast<std::vector<haddr_t>*>(list)->push_back(info->addr);
  return 0;
}

}  // namespace

std::vector<haddr_t> object_addresses(hid_t file) {
  std::vector<haddr_t> addresses;
  if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, add_address, &addresses, H5O_INFO_BASIC) < 0)
    throw IoError("listing its objects failed: " + failure_reason());
  return addresses;
}

void seal_file(const std::filesystem::path& path, const std::vector<haddr_t>& objects) {
  try {
    const RawFile file(path);
    append(path, seal_for(file, chunks_in(file, objects)));
  } catch (const Damaged&) {
    throw IoError("it cannot be read back");
  }
}

Seal seal_of(const RawFile& file, std::uint64_t end) {
  const Seal without = begins_seal(file, end) ? Seal::broken : Seal::none;  // it may be truncated
  if (file.size() < kSealBytes) return without;
  const std::vector<std::byte> footer = file.read(file.size() - kFooterBytes, kFooterBytes);
  const std::string text(reinterpret_cast<const char*>(footer.data()), footer.size());
  ByteCursor cursor(footer);
  const std::uint64_t count = cursor.number(8);
  const std::uint64_t size = cursor.number(8);
  const bool fits =
      count <= file.size() / kRangeBytes && size + count * kRangeBytes + kSealBytes == file.size();
  const bool is_signed = text.ends_with(kSignature);
  if (!fits && !is_signed) return without;
  if (!fits || !is_signed || !begins_seal(file, size)) return Seal::broken;
  try {
    const std::vector<std::byte> stored = file.read(size + kSignature.size(), count * kRangeBytes);
    ByteCursor numbers(stored);
    std::vector<ByteRange> ranges(count);
    for (ByteRange& range : ranges) {
      range.begin = numbers.number(8);
      range.end = numbers.number(8);
    }
    return hash_of(file, ranges, size) == text.substr(16, kHashDigits) ? Seal::intact : Seal::broken;
  } catch (const Damaged&) {
    return Seal::broken;
  }
}

bool has_seal(const std::filesystem::path& path) {
  const RawFile file(path);
  return seal_of(file, file.size()) != Seal::none;
}

}  // namespace landfall::h5
