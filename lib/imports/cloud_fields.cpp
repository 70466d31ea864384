// SPDX-License-Identifier: GPL-3.0-or-later
#include "imports/cloud_fields.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "base/error.h"
#include "base/shown_text.h"

namespace landfall {
namespace {

struct FieldNames {
  CloudField field;
  const char* name;
  std::vector<std::string_view> usual;  ///< as plain_name() writes them; the best first
};

/// Names that LAS tools, CloudCompare, PCL, HELIOS++, spreadsheets and landfall's own exports give to
/// columns.
const std::vector<FieldNames>& field_names() {
  static const std::vector<FieldNames> kNames = {
      {CloudField::x, "x", {"xest", "x", "e", "easting", "east", "lon", "longitude"}},
      {CloudField::y, "y", {"yest", "y", "n", "northing", "north", "lat", "latitude"}},
      {CloudField::z, "z", {"zest", "z", "h", "elevation", "elev", "height", "altitude", "alt"}},
      {CloudField::intensity, "intensity", {"intensity", "reflectance", "amplitude"}},
      {CloudField::return_number, "return_number", {"returnnumber", "returnnr"}},
      {CloudField::number_of_returns, "number_of_returns", {"numberofreturns", "numreturns"}},
      {CloudField::t, "t", {"t", "ts", "gpstime", "time", "times", "timestamp"}},
      {CloudField::pulse, "pulse", {"pulse", "fullwaveindex"}},
      {CloudField::pixel, "pixel", {"pixel"}},
      {CloudField::classification, "classification", {"classification"}}};
  return kNames;
}

/// In lower case, letters and digits only, without "scalar", a unit in brackets, and the unit _m.
std::string plain_name(std::string_view name) {
  const std::size_t bracket = name.find_first_of("([");
  if (bracket != std::string_view::npos && bracket > 0) name = name.substr(0, bracket);
  if (name.size() > 2 && name.substr(name.size() - 2) == "_m") name.remove_suffix(2);
  std::string plain;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return plain.starts_with("scalar") && plain.size() > 6 ? plain.substr(6) : plain;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 20;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kShown); ++i)
    list += (i > 0 ? ", " : "") + shown_word(names[i]);
  return names.size() > kShown ? list + ", ..." : list;
}

std::optional<std::size_t> column_number(const std::string& text, std::size_t count) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 1 || number > count)
    return std::nullopt;
  return number - 1;
}

[[noreturn]] void refuse_choice(CloudField field, const std::string& column, const std::string& what) {
  throw UsageError("--columns: " + std::string(name_of(field)) + "=" + shown_word(column) + ": " + what);
}

/// The column of a choice, by its name, else by its number.
std::size_t chosen_column(const std::vector<std::string>& names, CloudField field, const std::string& column,
                          const std::string& file) {
  const auto count = std::ranges::count(names, column);
  if (count > 1) refuse_choice(field, column, file + " has that column twice; give its number");
  if (count == 1) return static_cast<std::size_t>(std::ranges::find(names, column) - names.begin());
  if (const auto number = column_number(column, names.size())) return *number;
  refuse_choice(field, column, file + " has no such column; it has " + listed(names));
}

void take_choice(CloudColumns& columns, const std::vector<std::string>& names, const ColumnChoice& choice,
                 const std::string& file) {
  for (const auto& [field, column] : choice)
    columns[static_cast<std::size_t>(field)] = chosen_column(names, field, column, file);
}

/// The column with the best of a field's usual names.
std::optional<std::size_t> usual_column(const std::vector<std::string>& plain, const FieldNames& field,
                                        const std::string& file) {
  for (const std::string_view usual : field.usual) {
    const auto found = std::ranges::find(plain, usual);
    if (found == plain.end()) continue;
    if (std::find(found + 1, plain.end(), usual) != plain.end())
      throw FormatError(file + ": two of its columns could be " + field.name + "; choose one: --columns " +
                        field.name + "=NUMBER");
    return static_cast<std::size_t>(found - plain.begin());
  }
  return std::nullopt;
}

CloudColumns matched(const std::vector<std::string>& names, const ColumnChoice& choice,
                     const std::string& file) {
  CloudColumns columns;
  take_choice(columns, names, choice, file);
  std::vector<std::string> plain;
  for (const std::string& name : names) plain.push_back(plain_name(name));
  for (const FieldNames& field : field_names()) {
    std::optional<std::size_t>& column = columns[static_cast<std::size_t>(field.field)];
    if (!column) column = usual_column(plain, field, file);
  }
  return columns;
}

bool has_position(const CloudColumns& columns) { return columns[0] && columns[1] && columns[2]; }

}  // namespace

const char* name_of(CloudField field) { return field_names()[static_cast<std::size_t>(field)].name; }

std::optional<CloudField> cloud_field(std::string_view name) {
  for (const FieldNames& field : field_names())
    if (name == field.name) return field.field;
  return std::nullopt;
}

ColumnChoice column_choice(const std::string& text) {
  ColumnChoice choice;
  for (std::size_t begin = 0; begin <= text.size() && !text.empty();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals + 1 == part.size())
      throw UsageError("--columns: '" + shown_word(part) + "' is not FIELD=COLUMN, such as x=E");
    const auto field = cloud_field(part.substr(0, equals));
    if (!field)
      throw UsageError(
          "--columns: '" + shown_word(part.substr(0, equals)) +
          "' is not one of x, y, z, intensity, return_number, number_of_returns, t, pulse, pixel, "
          "classification");
    for (const auto& [known, column] : choice)
      if (known == *field) throw UsageError("--columns gives " + std::string(name_of(*field)) + " twice");
    choice.emplace_back(*field, part.substr(equals + 1));
  }
  return choice;
}

CloudColumns cloud_columns(const std::vector<std::string>& names, const ColumnChoice& choice,
                           const std::string& file) {
  CloudColumns columns = matched(names, choice, file);
  if (has_position(columns)) return columns;
  const char* const missing = !columns[0] ? "x" : !columns[1] ? "y" : "z";
  throw FormatError(file + ": no column is recognised as " + missing + "; it has " + listed(names) +
                    ": name it with --columns x=...,y=...,z=...");
}

CloudColumns numbered_columns(std::size_t count, const ColumnChoice& choice, const std::string& file) {
  std::vector<std::string> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(std::to_string(i + 1));
  CloudColumns columns;
  take_choice(columns, numbers, choice, file);
  for (std::size_t i = 0; i < 3; ++i)
    if (!columns[i] && i < count) columns[i] = i;
  if (!has_position(columns))
    throw FormatError(file + ": has " + std::to_string(count) + (count == 1 ? " column" : " columns") +
                      ", but a point has x, y and z");
  return columns;
}

bool names_a_cloud(const std::vector<std::string>& names, const ColumnChoice& choice) {
  try {
    return has_position(matched(names, choice, ""));
  } catch (const Error&) {
    return false;
  }
}

}  // namespace landfall
