// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/core/hash.h"

#include <xxhash.h>

#include <cstdio>
#include <new>

namespace landfall {

struct Hash::Impl {
  XXH3_state_t* state = XXH3_createState();
  Impl() {
    if (state == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(state);
  }
  ~Impl() { XXH3_freeState(state); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
};

Hash::Hash() : impl_(std::make_unique<Impl>()) {}
Hash::~Hash() = default;

Hash& Hash::update(std::span<const std::byte> bytes) {
  XXH3_128bits_update(impl_->state, bytes.data(), bytes.size());
  return *this;
}

Hash& Hash::update(std::string_view text) {
  const auto length = static_cast<std::uint64_t>(text.size());
  update(std::as_bytes(std::span(&length, 1)));
  return update(std::as_bytes(std::span(text)));
}

std::array<std::uint64_t, 2> Hash::words() const {
  const XXH128_hash_t digest = XXH3_128bits_digest(impl_->state);
  return {digest.high64, digest.low64};
}

std::string Hash::hex() const {
  const auto [high, low] = words();
  std::array<char, 33> text{};
  std::snprintf(text.data(), text.size(), "%016llx%016llx", static_cast<unsigned long long>(high),
                static_cast<unsigned long long>(low));
  return text.data();
}

}  // namespace landfall
