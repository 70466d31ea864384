// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/number_table.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "hdf5/table.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kHeader = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
const TableColumns kColumns{{"t_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"}, {"vx_mps"}};

class NumberTables : public testing::Test {
 protected:
  NumberTable read(const std::string& text) {
    std::ofstream(path_) << text;
    return read_number_table(path_, kColumns);
  }
  std::string refusal(const std::string& text) {
    try {
      static_cast<void>(read(text));
    } catch (const FormatError& error) {
      return error.what();
    }
    return "accepted";
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "table.csv";
};

void expect_one_row(const NumberTable& table) {
  ASSERT_EQ(table.row_count(), 1U);
  const std::array<double, 8> expected = {1.5, 2, -3, 4e2, 0.5, -0.5, 0.25, 0.125};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(table.column(kColumns.required[i]), std::vector<double>{expected[i]});
}

TEST_F(NumberTables, ReadsACsv) { expect_one_row(read(kHeader + "1.5,2,-3,4e2,0.5,-0.5,0.25,0.125\n")); }

TEST_F(NumberTables, ColumnsMayStandInAnyOrderAmongOthersWithBlanksAndComments) {
  expect_one_row(
      read("# made by hand\r\n\r\nqz, extra, x_m, y_m, z_m, qw, qx, qy, t_s\r\n"
           "# no data\r\n 0.125 , text, 2, -3, 400, 0.5, -0.5, 0.25, 1.5 \r\n\r\n"));
}

TEST_F(NumberTables, AnOptionalColumnMayBeMissing) {
  const std::string row = "0,0,0,0,1,0,0,0";
  EXPECT_FALSE(read(kHeader + row + "\n").has("vx_mps"));
  const NumberTable table = read("vx_mps," + kHeader + "7," + row + "\n");
  EXPECT_EQ(table.column("vx_mps"), std::vector<double>{7});
  EXPECT_FALSE(table.has("vy_mps"));
}

TEST_F(NumberTables, RefusalsNameFileAndLine) {
  EXPECT_THAT(refusal(""), AllOf(HasSubstr("table.csv"), HasSubstr("is empty")));
  EXPECT_THAT(refusal("t_s,x_m,y_m,z_m,qw,qx,qy\n"), AllOf(HasSubstr("line 1"), HasSubstr("no column qz")));
  EXPECT_THAT(refusal(kHeader + "0,1,2\n"), AllOf(HasSubstr("table.csv: line 2"), HasSubstr("3 values")));
  EXPECT_THAT(refusal(kHeader + "# c\n\n0,0,0,0,1,0,0,x\n"), AllOf(HasSubstr("line 4"), HasSubstr("qz 'x'")));
  EXPECT_THAT(refusal(kHeader + "0,0,,0,1,0,0,0\n"), HasSubstr("y_m '' is not a number"));
  EXPECT_THAT(refusal(kHeader + "0,0,1.5m,0,1,0,0,0\n"), HasSubstr("y_m '1.5m'"));
  EXPECT_THAT(refusal(kHeader + "0,0,1e999,0,1,0,0,0\n"), HasSubstr("y_m '1e999'"));
}

TEST_F(NumberTables, MissingFileAndFolder) {
  EXPECT_THROW(static_cast<void>(read_number_table(folder_ / "none.csv", kColumns)), FormatError);
  EXPECT_THROW(static_cast<void>(read_number_table(folder_ / ".", kColumns)), FormatError);
}

void write_column(hid_t file, const char* name, const std::vector<double>& values) {
  const h5::Handle dataset =
      h5::create_dataset(file, name, h5::Type::float64, {.size = {values.size()}, .chunk = {}});
  ASSERT_GE(H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
}

TEST_F(NumberTables, ReadsHdf5AndNamesWhatIsMissing) {
  h5::initialise();
  {
    const h5::Handle file = h5::create_file(path_);
    const std::array<double, 7> values = {1.5, 2, -3, 400, 0.5, -0.5, 0.25};
    const std::array<const char*, 7> names = {"t_s", "x_m", "y_m", "z_m", "qw", "qx", "qy"};
    for (std::size_t i = 0; i < names.size(); ++i) write_column(file.get(), names[i], {values[i]});
  }
  try {
    static_cast<void>(read_number_table(path_, kColumns));
    ADD_FAILURE() << "accepted";
  } catch (const FormatError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("table.csv"), HasSubstr("no column /qz")));
  }
  const h5::Handle file(H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  write_column(file.get(), "qz", {0.125});
  H5Fflush(file.get(), H5F_SCOPE_GLOBAL);
  expect_one_row(read_number_table(path_, kColumns));
}

TEST_F(NumberTables, Hdf5ColumnsMustBeOfOneLength) {
  h5::initialise();
  {
    const h5::Handle file = h5::create_file(path_);
    for (const char* const name : {"t_s", "x_m", "y_m", "z_m", "qw", "qx", "qy"})
      write_column(file.get(), name, {1, 2});
    write_column(file.get(), "qz", {1});
  }
  EXPECT_THROW(static_cast<void>(read_number_table(path_, kColumns)), FormatError);
}

}  // namespace
}  // namespace landfall
