// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/layer_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "base/core/error.h"
#include "refusal.h"

namespace landfall {
namespace {

template <class T>
std::string layer_refusal(const Grid<T>& layer, LayerValues allowed) {
  return refusal<FormatError>([&] { require_values(layer, "layer", allowed); });
}

TEST(LayerCheck, NamesTheFirstInfiniteValue) {
  Grid<float> layer(GridSpec::centered(1, 0.5));
  EXPECT_EQ(layer_refusal(layer, LayerValues::finite), "accepted");
  layer.at({3, 4}) = -HUGE_VALF;
  EXPECT_EQ(layer_refusal(layer, LayerValues::finite), "layer: the value in row 3, column 4 is infinite");
  layer.at({1, 2}) = HUGE_VALF;
  for (const LayerValues allowed : {LayerValues::finite, LayerValues::not_negative})
    EXPECT_EQ(layer_refusal(layer, allowed), "layer: the value in row 1, column 2 is infinite");
}

TEST(LayerCheck, RefusesNegativeValuesOnlyWhereTheyMeanNothing) {
  Grid<double> layer(GridSpec::centered(1, 0.5));
  layer.at({0, 0}) = std::nan("");
  layer.at({0, 1}) = -0.0;
  layer.at({2, 0}) = -0.05;
  EXPECT_EQ(layer_refusal(layer, LayerValues::finite), "accepted");
  EXPECT_EQ(layer_refusal(layer, LayerValues::not_negative),
            "layer: the value in row 2, column 0 is -0.05, and must be 0 or more");
  layer.at({2, 0}) = 0;
  EXPECT_EQ(layer_refusal(layer, LayerValues::not_negative), "accepted");
}

TEST(LayerCheck, TakesCounts) {
  Grid<std::int32_t> counts(GridSpec::centered(1, 0.5), 2147483647);
  EXPECT_EQ(layer_refusal(counts, LayerValues::not_negative), "accepted");
  counts.at({4, 4}) = -1;
  EXPECT_EQ(layer_refusal(counts, LayerValues::not_negative),
            "layer: the value in row 4, column 4 is -1, and must be 0 or more");
}

}  // namespace
}  // namespace landfall
