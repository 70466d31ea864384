// SPDX-License-Identifier: GPL-3.0-or-later
#include "imports/cloud_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::HasSubstr;

std::size_t column_of(CloudField field, const std::vector<std::string>& names,
                      const std::string& choice = "") {
  return cloud_columns(names, column_choice(choice), "f").at(static_cast<std::size_t>(field)).value();
}

TEST(CloudFields, AreFoundByTheirUsualNames) {
  for (const std::string name : {"x", "X", "E", "Easting [m]", "x_est_m", "Scalar_X", "lon", "EAST (ft)"})
    EXPECT_EQ(column_of(CloudField::x, {"n", "z", name}), 2U) << name;
  for (const std::string name : {"gps_time", "GpsTime", "t_s", "Timestamp"})
    EXPECT_EQ(column_of(CloudField::t, {"x", "y", "z", name}), 3U) << name;
}

TEST(CloudFields, TheBestNameWins) { EXPECT_EQ(column_of(CloudField::x, {"x", "x_est", "y", "z"}), 1U); }

TEST(CloudFields, AreChosenByNameOrNumber) {
  EXPECT_EQ(column_of(CloudField::x, {"a", "b", "c"}, "x=c,y=2,z=1"), 2U);
  EXPECT_EQ(column_of(CloudField::x, {"3", "b", "c"}, "x=3,y=2,z=1"), 0U);  // a name before a number
}

TEST(CloudFields, RefuseAWrongChoice) {
  const auto refused = [](const std::string& choice) {
    return refusal([&] { static_cast<void>(column_of(CloudField::x, {"x", "y", "z", "u", "u"}, choice)); });
  };
  EXPECT_THAT(refused("x"), HasSubstr("is not FIELD=COLUMN"));
  EXPECT_THAT(refused("x="), HasSubstr("is not FIELD=COLUMN"));
  EXPECT_THAT(refused("q=1"), HasSubstr("is not one of x, y, z"));
  EXPECT_THAT(refused("x=1,x=2"), HasSubstr("gives x twice"));
  EXPECT_THAT(refused("x=9"), HasSubstr("has no such column; it has x, y, z"));
  EXPECT_THAT(refused("x=0"), HasSubstr("has no such column"));
  EXPECT_THAT(refused("x=u"), HasSubstr("has that column twice"));
}

}  // namespace
}  // namespace landfall
