// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "imports/cloud_reader.h"
#include "raster/fill_search.h"

namespace landfall {

/// The values by which a user says "no return".
struct CloudNodata {
  std::vector<double> z{};  ///< points with one of these are left out
  bool keeps_undeclared_fills =
      false;  ///< others that look like fill values are points; else they are refused
};

/// Finds the positions that may be shared by more than 1 % of the points of a stream, in one pass and in
/// bounded memory. A position of so many points is one of more than 0.5 % of those of a window of the stream,
/// except of a last window that is too short to matter.
class SharedPositionSearch {
 public:
  void add(const std::array<double, 3>& position);
  /// Candidates after the last point: all positions of more than 1 %, and some of fewer points.
  [[nodiscard]] const std::set<std::array<double, 3>>& candidates();
  [[nodiscard]] std::int64_t total() const { return total_; }

 private:
  static constexpr std::size_t kWindow = std::size_t{1} << 18U;
  static constexpr std::size_t kCounters = 4096;
  static constexpr int kPart = 200;  ///< candidates are more than this part of a window

  void close_window();

  std::vector<std::array<double, 3>> window_;
  std::vector<std::uint32_t> counters_ = std::vector<std::uint32_t>(kCounters);  ///< points by their hash
  std::set<std::array<double, 3>> candidates_;
  std::int64_t total_ = 0;
};

/// A cloud without the points that a user declares to be fills. Its first pass refuses the others: those by
/// their z (raster/fill_search.h), and one position that at least 10 points and more than 1 % share. Points
/// that are not finite and points that LAS marks as withheld or as noise are not searched.
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
