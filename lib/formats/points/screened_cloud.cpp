// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/screened_cloud.h"

#include <algorithm>
#include <utility>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr std::int64_t kMinShared = 10;

/// Calls use(i) for the points of a batch that are searched.
template <class Use>
void for_each_searched(const CloudBatch& batch, const Use& use) {
  const std::vector<double>& classes = batch[CloudField::classification];
  for (std::size_t i = 0; i < batch.size(); ++i)
    if ((classes.empty() || !is_noise(classes[i])) && batch.has_position(i)) use(i);
}

SharedPositionSearch::Position position_of(const CloudBatch& batch, std::size_t i) {
  return {batch.columns[0][i], batch.columns[1][i], batch.columns[2][i]};
}

std::string remedy(const std::string& values) {
  return "give --nodata " + values + " to leave them out, or --nodata none to keep them";
}

}  // namespace

bool SharedPositionSearch::is_shared(std::int64_t count) const {
  return count >= kMinShared && 100 * count > total_;
}

bool SharedPositionSearch::needs_further_passes() const {
  return std::ranges::any_of(counts_, [&](std::int64_t count) { return is_shared(count); });
}

void SharedPositionSearch::propose(const Position& position) {
  if (!is_shared(counts_[hash_of(position)])) return;
  const auto candidate = candidates_.find(position);
  if (candidate != candidates_.end()) {
    ++candidate->second;
  } else if (candidates_.size() < kCandidates) {
    candidates_[position] = 1;
  } else {
    for (auto& [other, weight] : candidates_) --weight;
    std::erase_if(candidates_, [](const auto& entry) { return entry.second == 0; });
  }
}

void SharedPositionSearch::begin_count() {
  for (auto& [position, count] : candidates_) count = 0;
}

void SharedPositionSearch::count(const Position& position) {
  const auto candidate = candidates_.find(position);
  if (candidate != candidates_.end()) ++candidate->second;
}

std::map<SharedPositionSearch::Position, std::int64_t> SharedPositionSearch::shared() const {
  std::map<Position, std::int64_t> shared = candidates_;
  std::erase_if(shared, [&](const auto& entry) { return !is_shared(entry.second); });
  return shared;
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
  run_both([&] { for_each_searched(batch, [&](std::size_t i) { z_.add(batch.columns[2][i]); }); },
           [&] { for_each_searched(batch, [&](std::size_t i) { positions_.add(position_of(batch, i)); }); });
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

/// Calls use(position) in a pass over all points that are searched.
template <class Use>
void ScreenedCloud::for_each_position(const Use& use) {
  cloud_->rewind();
  for (CloudBatch batch; cloud_->next(batch);) {
    if (!nodata_.z.empty()) remove_nodata(batch);
    for_each_searched(batch, [&](std::size_t i) { use(position_of(batch, i)); });
  }
  left_out_now_ = 0;
}

void ScreenedCloud::refuse_shared_position() {
  if (!positions_.needs_further_passes()) return;
  for_each_position([&](const auto& position) { positions_.propose(position); });
  positions_.begin_count();
  for_each_position([&](const auto& position) { positions_.count(position); });
  for (const auto& [position, count] : positions_.shared())
    throw FormatError(name_ + ": " + grouped(count) + " of " + grouped(positions_.total()) +
                      " points share the position " + joined(position, ", ", number_text) +
                      ", which looks like that of pulses without a return; " +
                      remedy(number_text(position[2])));
}

}  // namespace landfall
