// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/runs/selected_cloud.h"

#include <utility>

#include "base/core/error.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

void require_returns(const CloudInfo& info, ReturnChoice choice, const std::string& path) {
  if (choice == ReturnChoice::all) return;
  const std::string option = choice == ReturnChoice::first ? "--first-only" : "--last-only";
  for (const CloudField field : {CloudField::return_number, CloudField::number_of_returns})
    if (!info.has(field) && (field == CloudField::return_number || choice == ReturnChoice::last))
      throw UsageError(option + ": " + path + " has no column " + name_of(field) +
                       ": leave the option out, or name the column with --columns " + name_of(field) +
                       "=...");
}

}  // namespace

SelectedCloud::SelectedCloud(std::unique_ptr<CloudReader> cloud, const std::string& path,
                             const CloudSelection& selection, const CloudAxes& axes)
    : cloud_(std::move(cloud)), info_(cloud_->info()), selection_(selection), axes_(axes) {
  require_returns(info_, selection.returns, path);
  rotate(axes_, info_);
}

bool SelectedCloud::next(CloudBatch& batch) {
  while (cloud_->next(batch)) {
    rotate(axes_, batch);
    batch.keep_if([&](std::size_t i) {
      std::int64_t* const reason = reason_to_leave_out(batch, i);
      if (reason != nullptr) ++*reason;
      return reason == nullptr;
    });
    if (batch.size() > 0) return true;
  }
  return false;
}

void SelectedCloud::rewind() {
  cloud_->rewind();
  left_out_ = {};
}

std::int64_t* SelectedCloud::reason_to_leave_out(const CloudBatch& batch, std::size_t i) {
  if (!batch.has_position(i)) return &left_out_.without_position;
  const std::vector<double>& classes = batch[CloudField::classification];
  if (!selection_.keep_noise && !classes.empty() && is_noise(classes[i]))
    return classes[i] == kWithheld ? &left_out_.withheld : &left_out_.noise;
  if (selection_.returns == ReturnChoice::all) return nullptr;
  const double number = batch[CloudField::return_number][i];
  const double wanted =
      selection_.returns == ReturnChoice::first ? 1 : batch[CloudField::number_of_returns][i];
  return number == wanted ? nullptr : &left_out_.other_returns;
}

std::vector<std::string> SelectedCloud::sentences() const {
  std::vector<std::string> sentences;
  const LeftOut& out = left_out_;
  if (out.without_position > 0)
    sentences.push_back(grouped(out.without_position) + " points without a finite position are left out");
  if (out.noise + out.withheld > 0)
    sentences.push_back(
        (out.noise > 0 ? grouped(out.noise) + " points that it marks as noise" : "") +
        (out.noise > 0 && out.withheld > 0 ? " and " : "") +
        (out.withheld > 0 ? grouped(out.withheld) + " points that it marks as withheld" : "") +
        " are left out (--keep-noise keeps them as false returns)");
  if (out.other_returns > 0)
    sentences.push_back(grouped(out.other_returns) + " points that are not " +
                        (selection_.returns == ReturnChoice::first ? "first" : "last") +
                        " returns are left out");
  return sentences;
}

}  // namespace landfall
