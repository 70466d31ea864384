// SPDX-License-Identifier: GPL-3.0-or-later
#include "imports/screened_cloud.h"

#include <algorithm>
#include <bit>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/joined.h"
#include "base/number_text.h"
#include "base/parallel.h"

namespace landfall {
namespace {

constexpr std::int64_t kLeastShared = 10;

std::size_t hash_of(const std::array<double, 3>& position) {
  std::uint64_t hash = 0;
  for (const double coordinate : position)  // -0 becomes 0
    hash = (std::rotl(hash, 21) ^ std::bit_cast<std::uint64_t>(coordinate + 0.0)) * 0x9E3779B97F4A7C15U;
  return static_cast<std::size_t>(hash >> 52U);
}

bool is_searched_point(const CloudBatch& batch, std::size_t i) {
  const std::vector<double>& classes = batch[CloudField::classification];
  return (classes.empty() || !is_noise(classes[i])) && batch.has_position(i);
}

std::string remedy(const std::string& values) {
  return "give --nodata " + values + " to leave them out, or --nodata none to keep them";
}

}  // namespace

void SharedPositionSearch::add(const std::array<double, 3>& position) {
  ++total_;
  window_.push_back(position);
  ++counters_[hash_of(position)];
  if (window_.size() == kWindow) close_window();
}

const std::set<std::array<double, 3>>& SharedPositionSearch::candidates() {
  if (static_cast<std::int64_t>(window_.size()) * kPart > total_) close_window();
  return candidates_;
}

void SharedPositionSearch::close_window() {
  const std::size_t least = window_.size() / kPart;
  if (std::ranges::any_of(counters_, [&](std::uint32_t count) { return count > least; })) {
    std::map<std::array<double, 3>, std::size_t> counts;
    for (const auto& position : window_)
      if (counters_[hash_of(position)] > least) ++counts[position];
    for (const auto& [position, count] : counts)
      if (count > least) candidates_.insert(position);
  }
  std::ranges::fill(counters_, 0U);
  window_.clear();
}

ScreenedCloud::ScreenedCloud(std::unique_ptr<CloudReader> cloud, std::string name, CloudNodata nodata)
    : cloud_(std::move(cloud)),
      name_(std::move(name)),
      nodata_(std::move(nodata)),
      is_searched_(nodata_.keeps_undeclared_fills) {
  info_ = cloud_->info();
}

bool ScreenedCloud::next(CloudBatch& batch) {
  if (!cloud_->next(batch)) {
    left_out_ = std::exchange(left_out_now_, 0);
    if (!std::exchange(is_searched_, true)) refuse_fills();
    return false;
  }
  if (!nodata_.z.empty()) remove_nodata(batch);
  if (!is_searched_) search(batch);
  return true;
}

void ScreenedCloud::remove_nodata(CloudBatch& batch) {
  const std::size_t all = batch.size();
  const std::vector<double>& z = batch.columns[2];
  batch.keep_if([&](std::size_t i) { return std::ranges::find(nodata_.z, z[i]) == nodata_.z.end(); });
  left_out_now_ += static_cast<std::int64_t>(all - batch.size());
}

/// The two searches share nothing, so that each has a thread.
void ScreenedCloud::search(const CloudBatch& batch) {
  parallel_for(2, 1, [&](std::size_t part, std::size_t) {
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (!is_searched_point(batch, i)) continue;
      if (part == 0)
        z_.add(batch.columns[2][i]);
      else
        positions_.add({batch.columns[0][i], batch.columns[1][i], batch.columns[2][i]});
    }
  });
}

void ScreenedCloud::refuse_fills() {
  refuse_shared_position();
  const FillSearch::Result found = z_.result();
  if (found.fills.empty()) return;
  const std::string others = found.rest.empty() ? ""
                                                : " (the others lie in " + short_number(found.rest.low) +
                                                      " .. " + short_number(found.rest.high) + ")";
  throw FormatError(name_ + ": " + grouped(count_of(found.fills)) + " of " + grouped(found.total) +
                    " points have z " + suspicion_text(found.fills) + others + "; " +
                    remedy(nodata_text(found.fills)));
}

/// Counts the candidates in a pass of its own, for the few files that have any.
void ScreenedCloud::refuse_shared_position() {
  std::map<std::array<double, 3>, std::int64_t> counts;
  for (const std::array<double, 3>& candidate : positions_.candidates()) counts[candidate] = 0;
  if (counts.empty()) return;
  cloud_->rewind();
  for (CloudBatch batch; cloud_->next(batch);) {
    if (!nodata_.z.empty()) remove_nodata(batch);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (!is_searched_point(batch, i)) continue;
      const auto candidate = counts.find({batch.columns[0][i], batch.columns[1][i], batch.columns[2][i]});
      if (candidate != counts.end()) ++candidate->second;
    }
  }
  left_out_now_ = 0;
  for (const auto& [position, count] : counts)
    if (count >= kLeastShared && 100 * count > positions_.total())
      throw FormatError(name_ + ": " + grouped(count) + " of " + grouped(positions_.total()) +
                        " points share the position " + joined(position, ", ", number_text) +
                        ", which looks like that of pulses without a return; " +
                        remedy(number_text(position[2])));
}

}  // namespace landfall
