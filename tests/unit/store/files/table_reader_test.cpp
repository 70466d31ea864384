// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/table_reader.h"

#include <gmock/gmock.h>

#include "base/core/error.h"
#include "refusal.h"
#include "store/hdf5/table.h"
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
    std::ofstream(path_) << text;
    return refusal_of_file();
  }
  std::string refusal_of_file() {
    return landfall::refusal<FormatError>([&] { return read_number_table(path_, kColumns); });
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

std::string replaced(std::string text, char from, const std::string& to) {
  std::string result;
  for (const char c : text) result += c == from ? to : std::string(1, c);
  return result;
}

const std::string kRow = "1.5,2,-3,4e2,0.5,-0.5,0.25,0.125";

TEST_F(NumberTables, CellsAreSeparatedByCommaSemicolonTabOrBlanks) {
  for (const char* const separator : {",", ";", "\t", " ", "   ", " ; ", ", ", " \t"})
    expect_one_row(read(replaced(kHeader + kRow + "\n", ',', separator)));
  expect_one_row(read("  " + replaced(kHeader + "  " + kRow + "  \n", ',', "  ")));
  expect_one_row(read("empty\t" + replaced(kHeader + ",", ',', "\t").substr(0, kHeader.size()) + "\t" +
                      replaced(kRow, ',', "\t") + "\n"));
}

TEST_F(NumberTables, LinesEndWithLfCrLfOrCr) {
  for (const char* const end : {"\n", "\r\n", "\r"})
    for (const char* const mark : {"", "\xEF\xBB\xBF"})
      expect_one_row(read(mark + replaced("# c\n\n" + kHeader + kRow + "\n", '\n', end)));
  expect_one_row(read(kHeader + kRow));
}

TEST_F(NumberTables, NamesAndNumbersMayBeQuotedAndInCapitals) {
  const auto quoted = [](const std::string& line, const std::string& quote) {
    return quote + replaced(line, ',', quote + "," + quote) + quote + "\n";
  };
  const std::string names = kHeader.substr(0, kHeader.size() - 1);
  for (const char* const quote : {"\"", "'"}) {
    expect_one_row(read(quoted(names, quote) + kRow));
    expect_one_row(read(quoted(names, quote) + quoted(kRow, quote)));
  }
  expect_one_row(read("T_S,X_m,Y_M,z_m,QW,qX,Qy,QZ,\"a, b; c\"\n" + kRow + ",\"1, 2\"\n"));
  const NumberTable table = read("VX_MPS," + kHeader + "7," + kRow + "\n");
  EXPECT_EQ(table.column("vx_mps"), std::vector<double>{7});
}

TEST_F(NumberTables, ReadsNumbersOfOtherPrograms) {
  expect_one_row(read(kHeader + "+1.5e0,2.0D+00,-3d0,+4E+02,5e-1,-.5,.25,0.125\n"));
  const NumberTable table = read(kHeader + "1e-400,-1e-400,0,0,1,0,0,0\n");
  EXPECT_EQ(table.column("t_s"), std::vector<double>{0});
  EXPECT_EQ(table.column("x_m"), std::vector<double>{0});
  EXPECT_THAT(refusal(kHeader + "0,0,1e400,0,1,0,0,0\n"),
              HasSubstr("y_m '1e400' is beyond double precision"));
  EXPECT_THAT(refusal(kHeader + "+-1,0,0,0,1,0,0,0\n"), HasSubstr("t_s '+-1' is not a number"));
}

TEST_F(NumberTables, NamesDecimalCommas) {
  EXPECT_THAT(refusal(replaced(kHeader, ',', ";") + "0;1,5;0;0;1;0;0;0\n"),
              HasSubstr("x_m '1,5' is not a number: write decimals with a point"));
  EXPECT_THAT(refusal(replaced(kHeader, ',', " ") + "0 1,5 0 0 1 0 0 0\n"),
              HasSubstr("write decimals with a point"));
  EXPECT_THAT(refusal(kHeader + "0,0,1,5,0,0,0,0,1,0,0,0,0,0,0,0\n"),
              HasSubstr("16 values; the header names 8; write decimals with a point"));
}

// numpy.savetxt writes its header as a comment; MATLAB's comments begin with %.
TEST_F(NumberTables, AHeaderMayBeAComment) {
  for (const char* const mark : {"# ", "#", "% ", "%%"}) {
    expect_one_row(read("# made by hand\n" + (mark + kHeader) + kRow + "\n"));
    expect_one_row(read(mark + kHeader + "# and more\n" + replaced(kRow, ',', " ") + "\n"));
  }
  EXPECT_THAT(refusal("# time x y z\n" + kRow + "\n"), HasSubstr("line 2: begins with the number"));
  EXPECT_THAT(refusal("# " + kHeader), HasSubstr("has comments only"));
}

TEST_F(NumberTables, AWantedColumnMayNotBeThereTwice) {
  EXPECT_THAT(refusal("X_M," + kHeader + "7," + kRow + "\n"),
              HasSubstr("column x_m is given twice, as 'X_M' and 'x_m'"));
  EXPECT_THAT(refusal("vx_mps,Vx_mps," + kHeader), HasSubstr("column vx_mps is given twice"));
  EXPECT_EQ(read("a,a," + kHeader + "7,8," + kRow + "\n").row_count(), 1U);
}

TEST_F(NumberTables, AllColumnsNeedDistinctNames) {
  const TableColumns all{.all = true};
  const auto read_all = [&](const std::string& text) {
    std::ofstream(path_) << text;
    return read_number_table(path_, all);
  };
  EXPECT_EQ(read_all("scan.a; Scan.B\n+1;2\n").names(), (std::vector<std::string>{"scan.a", "scan.b"}));
  EXPECT_EQ(read_all("# a b\n1 2\n").column("b"), std::vector<double>{2});
  EXPECT_THROW(read_all("a,A\n1,2\n"), FormatError);
  EXPECT_THROW(read_all("a,\n1,2\n"), FormatError);
  EXPECT_THROW(read_all("1,2\n"), FormatError);
}

TEST_F(NumberTables, NamesOtherKindsOfFiles) {
  const auto zeros = [](std::size_t size) { return std::string(size, '\0'); };
  std::string utf16;
  for (const char c : kHeader) utf16 += {c, '\0'};
  EXPECT_THAT(refusal("\xFF\xFE" + utf16), HasSubstr("table.csv: is UTF-16 text: save it as UTF-8"));
  EXPECT_THAT(refusal(utf16), HasSubstr("is UTF-16 text"));
  EXPECT_THAT(refusal("\xFE\xFF" + zeros(1) + utf16.substr(0, 9)), HasSubstr("is UTF-16 text"));
  EXPECT_THAT(refusal("PK\x03\x04 and so on"), HasSubstr(".xlsx"));
  EXPECT_THAT(refusal("MATLAB 5.0 MAT-file, Platform: GLNXA64"), HasSubstr("save it with -v7.3"));
  EXPECT_THAT(refusal("\x1F\x8B and so on"), HasSubstr("gunzip"));
  EXPECT_THAT(refusal("\x01" + zeros(271)),
              AllOf(HasSubstr("SBET"), HasSubstr("the columns t_s, x_m, y_m, z_m")));
  EXPECT_THAT(refusal("\x01" + zeros(100)), HasSubstr("is binary"));
  EXPECT_THAT(refusal("#HEADER: \"t\", \"roll\", \"pitch\", \"yaw\", \"x\", \"y\", \"z\"\n0,0,0,0,0,0,0\n"),
              AllOf(HasSubstr("HELIOS++"), HasSubstr("the columns t_s, x_m, y_m, z_m")));
  path_ = folder_ / "a.trj";
  EXPECT_THAT(refusal("0 0 0 0 0 0 0\n"), HasSubstr("HELIOS++"));
  EXPECT_THAT(refusal("t,roll,pitch,yaw,x,y,z\n"), HasSubstr("HELIOS++"));
  expect_one_row(read(kHeader + kRow));
}

TEST_F(NumberTables, SaysWhatItSawAndWhatItWants) {
  EXPECT_THAT(
      refusal("time,x,y,z\n0,0,0,0\n"),
      HasSubstr("line 1: the header: no column t_s, x_m, y_m, z_m, qw, qx, qy, qz; it has time, x, y, z and "
                "needs t_s, x_m, y_m, z_m"));
  EXPECT_THAT(refusal(replaced(kHeader, ',', "|")), HasSubstr("it has t_s|x_m|y_m"));
}

TEST_F(NumberTables, MissingFileAndFolder) {
  EXPECT_THROW(static_cast<void>(read_number_table(folder_ / "none.csv", kColumns)), FormatError);
  EXPECT_THROW(static_cast<void>(read_number_table(folder_ / ".", kColumns)), FormatError);
}

void write_column(hid_t file, const std::string& name, const std::vector<double>& values,
                  std::vector<hsize_t> shape = {}) {
  if (shape.empty()) shape = {values.size()};
  const h5::Handle dataset = h5::create_dataset(file, name, h5::Type::float64, {.size = shape, .chunk = {}});
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
  EXPECT_THAT(refusal_of_file(),
              AllOf(HasSubstr("table.csv"),
                    HasSubstr("no column qz; it has t_s, x_m, y_m, z_m, qw, qx, qy and needs")));
  const h5::Handle file(H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  write_column(file.get(), "qz", {0.125});
  H5Fflush(file.get(), H5F_SCOPE_GLOBAL);
  expect_one_row(read_number_table(path_, kColumns));
}

/// Writes the values of kRow, each twice, into groups ("" for the root) of a new file.
void write_columns(const std::filesystem::path& path, const std::vector<hsize_t>& shape,
                   const std::vector<std::string>& groups, const std::vector<std::string>& names) {
  h5::initialise();
  const h5::Handle file = h5::create_file(path);
  const std::array<double, 8> values = {1.5, 2, -3, 400, 0.5, -0.5, 0.25, 0.125};
  for (const std::string& group : groups) {
    const h5::Handle created = group.empty() ? h5::Handle() : h5::create_group(file.get(), group);
    for (std::size_t i = 0; i < names.size(); ++i)
      write_column(created ? created.get() : file.get(), names[i], {values[i], values[i]}, shape);
  }
}

TEST_F(NumberTables, Hdf5ColumnsMayBeMatricesOfOneRowOrColumn) {
  for (const std::vector<hsize_t>& shape : {std::vector<hsize_t>{2}, {1, 2}, {2, 1}}) {
    write_columns(path_, shape, {""}, kColumns.required);
    const NumberTable table = read_number_table(path_, kColumns);
    EXPECT_EQ(table.column("z_m"), (std::vector<double>{400, 400}));
    std::filesystem::remove(path_);
  }
}

TEST_F(NumberTables, Hdf5ColumnsMayBeInTheOnlyGroupThatHasThem) {
  const std::vector<std::string> capitals = {"T_S", "X_M", "Y_M", "Z_M", "QW", "QX", "QY", "QZ"};
  write_columns(path_, {1, 2}, {"flight"}, capitals);
  EXPECT_EQ(read_number_table(path_, kColumns).column("qz"), (std::vector<double>{0.125, 0.125}));
  std::filesystem::remove(path_);
  write_columns(path_, {2}, {"a"}, {"t_s", "x_m"});
  EXPECT_THAT(refusal_of_file(), AllOf(HasSubstr("no column t_s"), HasSubstr("it has none and needs t_s"),
                                       HasSubstr("nor has any of its groups: /a")));
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
