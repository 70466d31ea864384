// SPDX-License-Identifier: GPL-3.0-or-later
#include "hdf5/guard/metadata_guard.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "hdf5/guard/file_seal.h"

namespace landfall::h5 {
namespace {

bool is_hdf5(const RawFile& file) {
  constexpr std::array<unsigned char, 8> kSignature = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
  if (file.size() < kSignature.size()) return false;
  const std::vector<std::byte> start = file.read(0, kSignature.size());
  return std::ranges::equal(start, std::as_bytes(std::span(kSignature)));
}

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
    throw FormatError(name_ + ": is an HDF5 file that is truncated or damaged; make it again");
  }
}

void MetadataGuard::check(std::uint64_t address, const std::string& path) {
  try {
    if (check_) check_->check_object(address);
  } catch (const Damaged&) {
    throw FormatError(name_ + ": " + path + " cannot be read: it is damaged");
  }
}

}  // namespace landfall::h5
