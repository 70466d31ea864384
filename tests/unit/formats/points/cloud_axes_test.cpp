// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/cloud_axes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace landfall {
namespace {

using testing::ElementsAre;

CloudInfo info_of() {
  CloudInfo info;
  info.steps = {.scale = {1, 2, 3}, .offset = {10, 20, 30}};
  info.box = {.low = {0, -5, 7}, .high = {1, 6, 9}};
  return info;
}

TEST(CloudAxes, LeaveOtherFilesAlone) {
  CloudBatch batch;
  batch.columns[0] = {1};
  batch.columns[1] = {2};
  batch.columns[2] = {3};
  rotate({}, batch);
  EXPECT_THAT(batch.columns[1], ElementsAre(2));
  CloudInfo info = info_of();
  rotate({}, info);
  EXPECT_THAT(info.box->low, ElementsAre(0, -5, 7));
}

TEST(CloudAxes, TurnYUp) {
  CloudBatch batch;
  batch.columns[0] = {1, 4};
  batch.columns[1] = {2, 5};
  batch.columns[2] = {3, -6};
  rotate({.y_up = true}, batch);
  EXPECT_THAT(batch.columns[0], ElementsAre(1, 4));
  EXPECT_THAT(batch.columns[1], ElementsAre(-3, 6));
  EXPECT_THAT(batch.columns[2], ElementsAre(2, 5));
  CloudInfo info = info_of();
  rotate({.y_up = true}, info);
  EXPECT_THAT(info.box->low, ElementsAre(0, -9, -5));
  EXPECT_THAT(info.box->high, ElementsAre(1, -7, 6));
  EXPECT_THAT(info.steps->scale, ElementsAre(1, 3, 2));
}

TEST(CloudAxes, SwapLatitudeAndLongitude) {
  CloudBatch batch;
  batch.columns[0] = {39};
  batch.columns[1] = {-83};
  batch.columns[2] = {1};
  rotate({.latitude_first = true}, batch);
  EXPECT_THAT(batch.columns[0], ElementsAre(-83));
  EXPECT_THAT(batch.columns[1], ElementsAre(39));
  CloudInfo info = info_of();
  rotate({.latitude_first = true}, info);
  EXPECT_THAT(info.box->high, ElementsAre(6, 1, 9));
  EXPECT_THAT(info.steps->offset, ElementsAre(20, 10, 30));
  CloudInfo none;
  rotate({.latitude_first = true, .y_up = true}, none);
  EXPECT_FALSE(none.box);
}

}  // namespace
}  // namespace landfall
