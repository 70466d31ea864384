// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/cloud_units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud_files.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

UnitConversion conversion_of(const std::string& header, bool has_crs,
                             std::optional<double> vertical_scale = {}) {
  return unit_conversion(read_cloud("a.csv", header + "\n1,2,3,4\n").info, has_crs, vertical_scale);
}

TEST(CloudUnits, EachColumnIsConvertedByItsOwnUnit) {
  const UnitConversion conversion = conversion_of("x [km],y [mm],z [ft],t [ms]", false);
  EXPECT_THAT(conversion.factors, ElementsAre(1000, 0.001, 0.3048, 1, 1, 1, 0.001, 1, 1, 1));
  EXPECT_THAT(conversion.notes,
              ElementsAre(HasSubstr("x in km, y in mm, z in ft: converted to metres"), HasSubstr("t in ms")));
  EXPECT_THAT(conversion_of("x [m],y [m],z [m],t [s]", false).notes, IsEmpty());
}

TEST(CloudUnits, WithACrsTheMapKeepsItsUnit) {
  const UnitConversion conversion = conversion_of("x [km],y [km],z [ft],t", true);
  EXPECT_THAT(conversion.factors, ElementsAre(1, 1, 0.3048, 1, 1, 1, 1, 1, 1, 1));
}

TEST(CloudUnits, TheVerticalScaleOfTheUserWins) {
  const UnitConversion conversion = conversion_of("x [m],y [m],z [ft],t", false, 2);
  EXPECT_EQ(conversion.factors[2], 1);
  EXPECT_THAT(conversion.notes, ElementsAre(HasSubstr("gives z in ft, but --vertical-scale 2 is taken")));
  EXPECT_THAT(conversion_of("x [m],y [m],z [ft],t", false, 0.3048).notes, IsEmpty());
}

TEST(CloudUnits, TheReaderMultipliesEveryPass) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.csv") << "x [mm],y [mm],z [ft]\n1000,2000,10\n";
  std::unique_ptr<CloudReader> cloud = open_cloud(folder / "a.csv");
  const UnitConversion conversion = unit_conversion(cloud->info(), false, {});
  cloud = converted(std::move(cloud), conversion);
  for (int pass = 0; pass < 2; ++pass) {
    CloudBatch batch;
    ASSERT_TRUE(cloud->next(batch));
    EXPECT_THAT(batch[CloudField::x], ElementsAre(1));
    EXPECT_THAT(batch[CloudField::z], ElementsAre(testing::DoubleEq(3.048)));
    EXPECT_FALSE(cloud->next(batch));
    cloud->rewind();
  }
}

}  // namespace
}  // namespace landfall
