// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/raster/fill_search.h"
#include "formats/points/cloud_reader.h"

namespace landfall {

/// The values by which a user says "no return".
struct CloudNodata {
  std::vector<double> z{};  ///< points with one of these are left out
  bool keeps_undeclared_fills =
      false;  ///< others that look like fill values are points; else they are refused
};

/// Finds the positions that at least 10 points and more than 1 % of a stream share, exactly, in any order and
/// in bounded memory. Three passes over the same points; nearly all streams need the first alone.
class SharedPositionSearch {
 public:
  using Position = std::array<double, 3>;

  /// First pass. Counts the points by a hash of their position: a position has no more than its hash.
  void add(const Position& position) {
    ++total_;
    ++counts_[hash_of(position)];
  }
  /// Whether a hash has as many points as a shared position; else none is shared.
  [[nodiscard]] bool needs_further_passes() const;
  /// Second pass. Keeps 100 candidates of these hashes by the algorithm of Misra and Gries (1982): each
  /// position of more than one in 101 points is one of them.
  void propose(const Position& position);
  /// Between the second pass and the third.
  void begin_count();
  /// Third pass.
  void count(const Position& position);
  /// The shared positions, with their numbers of points.
  [[nodiscard]] std::map<Position, std::int64_t> shared() const;
  [[nodiscard]] std::int64_t total() const { return total_; }

 private:
  static constexpr unsigned kHashBits = 11;
  static constexpr std::size_t kCandidates = 100;

  /// Equal for 0 and -0.
  [[nodiscard]] static std::size_t hash_of(const Position& position) {
    std::uint64_t hash = 0;
    for (const double coordinate : position)  // -0 becomes 0
      hash = (std::rotl(hash, 21) ^ std::bit_cast<std::uint64_t>(coordinate + 0.0)) * 0x9E3779B97F4A7C15U;
    return static_cast<std::size_t>(hash >> (64U - kHashBits));
  }
  [[nodiscard]] bool is_shared(std::int64_t count) const;

  std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(std::size_t{1} << kHashBits);
  std::map<Position, std::int64_t> candidates_;
  std::int64_t total_ = 0;
};

/// A cloud without the points that a user declares to be fills. Its first pass refuses the others: those by
/// their z (base/raster/fill_search.h), and one position that at least 10 points and more than 1 % share.
/// Points that are not finite and points that LAS marks as withheld or as noise are not searched.
class ScreenedCloud final : public CloudReader {
 public:
  /// `name` begins messages.
  ScreenedCloud(std::unique_ptr<CloudReader> cloud, std::string name, CloudNodata nodata);
  bool next(CloudBatch& batch) override;
  void rewind() override { cloud_->rewind(); }
  [[nodiscard]] double progress() const override { return cloud_->progress(); }
  /// The points that the last complete pass left out.
  [[nodiscard]] std::int64_t left_out() const { return left_out_; }

 private:
  void remove_nodata(CloudBatch& batch);
  void search(const CloudBatch& batch);
  void refuse_fills();
  void refuse_shared_position();
  template <class Use>
  void for_each_position(const Use& use);

  std::unique_ptr<CloudReader> cloud_;
  std::string name_;
  CloudNodata nodata_;
  FillSearch z_;
  SharedPositionSearch positions_;
  bool is_searched_;
  std::int64_t left_out_ = 0;
  std::int64_t left_out_now_ = 0;  ///< in this pass
};

}  // namespace landfall
