// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D443
#include "formats/points/cloud_fields.h"

#include <algorithm>

#include "base/core/error.h"
#include "base/text/characters.h"
#include "base/text/joined.h"
#include "base/text/shown_text.h"
#include "base/text/split_text.h"

namespace landfall {
namespace {

constexpr std::string_view kLeftOut = "-";

struct FieldNames {
  CloudField field;
  const char* name;
  std::vector<std::string_view> usual;  ///< as NameReading::plain; the best first
};

/// Names that LAS tools, CloudCompare, PCL, HELIOS++, spreadsheets, LVIS and landfall's own exports give to
/// columns. LVIS has three positions of each shot: that of the lowest mode, which is the ground, comes first.
const std::vector<FieldNames>& field_names() {
  static const std::vector<FieldNames> kNames = {
      {CloudField::x,
       "x",
       {"xest", "x", "e", "easting", "east", "lon", "longitude", "long", "lng", "decimallongitude",
        "longitudelow", "glon", "longitudecentroid"}},
      {CloudField::y,
       "y",
       {"yest", "y", "n", "northing", "north", "lat", "latitude", "decimallatitude", "latitudelow", "glat",
        "latitudecentroid"}},
      {CloudField::z,
       "z",
       {"zest", "z", "h", "elevation", "elev", "height", "altitude", "alt", "u", "up", "elevationlow", "zg",
        "elevationcentroid"}},
      {CloudField::intensity, "intensity", {"intensity", "reflectance", "amplitude"}},
      {CloudField::return_number, "return_number", {"returnnumber", "returnnr"}},
      {CloudField::number_of_returns, "number_of_returns", {"numberofreturns", "numreturns"}},
      {CloudField::t, "t", {"t", "gpstime", "time", "timestamp"}},
      {CloudField::pulse, "pulse", {"pulse", "fullwaveindex"}},
      {CloudField::pixel, "pixel", {"pixel"}},
      {CloudField::classification, "classification", {"classification"}},
      {CloudField::echo_width, "echo_width", {}}};
  return kNames;
}

std::optional<CloudField> cloud_field(std::string_view name) {
  for (const FieldNames& field : field_names())
    if (name == field.name) return field.field;
  return std::nullopt;
}

using Readings = std::vector<std::vector<NameReading>>;

Readings read_names(const std::vector<std::string>& names) {
  Readings readings;
  for (const std::string& name : names) readings.push_back(readings_of(name));
  return readings;
}

bool fits(CloudField field, ColumnUnit::Kind kind) {
  using enum ColumnUnit::Kind;
  if (kind == unstated) return true;
  if (field == CloudField::t) return kind == time;
  return kind == length || (kind == angle && field != CloudField::z);
}

bool has_unit(CloudField field) { return field <= CloudField::z || field == CloudField::t; }

std::string first_names(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 20;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kShown); ++i)
    list += (i > 0 ? ", " : "") + shown_word(names[i]);
  return names.size() > kShown ? list + ", ..." : list;
}

std::optional<std::size_t> column_number(const std::string& text, std::size_t count) {
  const auto number = exact_number<std::size_t>(text);
  return number && *number >= 1 && *number <= count ? std::optional(*number - 1) : std::nullopt;
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
  refuse_choice(field, column, file + " has no such column; it has " + first_names(names));
}

void take_choice(CloudColumns& columns, const std::vector<std::string>& names, const ColumnChoice& choice,
                 const std::string& file) {
  for (const auto& [field, column] : choice)
    if (column != kLeftOut)
      columns[static_cast<std::size_t>(field)] = chosen_column(names, field, column, file);
}

/// The column with the best of a field's usual names; one whose whole name is usual before one with a unit
/// behind it.
std::optional<std::size_t> usual_column(const Readings& readings, const FieldNames& field,
                                        const std::string& file) {
  for (const std::string_view usual : field.usual)
    for (const bool is_suffix : {false, true}) {
      const auto is_usual = [&](const std::vector<NameReading>& name) {
        return std::ranges::any_of(name, [&](const NameReading& reading) {
          return reading.plain == usual && reading.is_suffix == is_suffix &&
                 (!is_suffix || (has_unit(field.field) && fits(field.field, reading.unit.kind)));
        });
      };
      const auto found = std::ranges::find_if(readings, is_usual);
      if (found == readings.end()) continue;
      if (std::find_if(found + 1, readings.end(), is_usual) != readings.end())
        throw FormatError(file + ": two of its columns could be " + field.name + "; choose one: --columns " +
                          field.name + "=NUMBER");
      return static_cast<std::size_t>(found - readings.begin());
    }
  return std::nullopt;
}

/// The unit of a column as the values of a field.
ColumnUnit field_unit(CloudField field, const std::vector<NameReading>& readings) {
  for (const NameReading& reading : readings)
    if (reading.is_suffix && fits(field, reading.unit.kind)) return reading.unit;
  return readings.front().unit;
}

CloudTable matched(const std::vector<std::string>& names, const ColumnChoice& choice,
                   const std::string& file) {
  CloudTable table;
  take_choice(table.columns, names, choice, file);
  const Readings readings = read_names(names);
  for (const FieldNames& field : field_names()) {
    const auto f = static_cast<std::size_t>(field.field);
    std::optional<std::size_t>& column = table.columns[f];
    if (!is_chosen(choice, field.field)) column = usual_column(readings, field, file);
    if (column && has_unit(field.field)) table.units[f] = field_unit(field.field, readings[*column]);
  }
  return table;
}

const char* plain_unit_of(CloudField field) { return field == CloudField::t ? "seconds" : "metres"; }

/// Refuses units that are not those of their field. A user who chooses a column vouches for it.
void check_units(CloudTable& table, const std::vector<std::string>& names, const ColumnChoice& choice,
                 const std::string& file) {
  for (const FieldNames& field : field_names()) {
    const auto f = static_cast<std::size_t>(field.field);
    ColumnUnit& unit = table.units[f];
    if (fits(field.field, unit.kind)) continue;
    const std::size_t column = *table.columns[f];
    const std::string what = "'" + shown_word(unit.text) + "' in the name of its column '" +
                             shown_word(names[column]) + "' is not a unit of " +
                             (field.field == CloudField::t ? "time" : "length") + " that is known: ";
    if (!is_chosen(choice, field.field))
      throw FormatError(file + ": " + what + "--columns " + field.name + "=" + std::to_string(column + 1) +
                        " takes it in " + plain_unit_of(field.field) +
                        (field.field == CloudField::t ? ", t=- leaves it out" : ""));
    table.notes.push_back(what + plain_unit_of(field.field) + " are assumed");
    unit = {};
  }
}

std::string described(const ColumnUnit& unit) {
  if (unit.kind == ColumnUnit::Kind::unstated) return "no unit";
  return unit.text.empty() ? "degrees" : shown_word(unit.text);
}

void require_like_units(const CloudTable& table, const std::vector<std::string>& names,
                        const std::string& file) {
  const ColumnUnit& x = table.units[0];
  const ColumnUnit& y = table.units[1];
  const auto is_plain = [](const ColumnUnit& unit) {
    return unit.kind == ColumnUnit::Kind::unstated ||
           (unit.kind == ColumnUnit::Kind::length && unit.factor == 1);
  };
  if (x.kind == y.kind || (is_plain(x) && is_plain(y))) return;
  throw FormatError(file + ": by its header x ('" + shown_word(names[*table.columns[0]]) + "') has " +
                    described(x) + " and y ('" + shown_word(names[*table.columns[1]]) + "') has " +
                    described(y) + ": correct the header, or choose other columns with --columns");
}

/// LVIS has further positions of each shot.
void note_lowest_mode(CloudTable& table, const std::vector<std::string>& names) {
  const std::string& z = names[*table.columns[2]];
  const std::string plain = readings_of(z).front().plain;
  if (plain != "elevationlow" && plain != "zg") return;
  table.notes.push_back("its columns " + shown_word(names[*table.columns[0]]) + ", " +
                        shown_word(names[*table.columns[1]]) + ", " + shown_word(z) +
                        " are taken as x, y, z: the lowest mode of each shot, the ground (--columns chooses "
                        "other columns)");
}

bool has_position(const CloudColumns& columns) { return columns[0] && columns[1] && columns[2]; }

void require_position_fields(CloudField field, const std::string& column) {
  if (column == kLeftOut && field <= CloudField::z)
    throw UsageError("--columns: " + std::string(name_of(field)) +
                     "=-: a point has x, y and z; other fields can be left out");
}

}  // namespace

const char* name_of(CloudField field) { return field_names()[static_cast<std::size_t>(field)].name; }

ColumnChoice column_choice(const std::string& text) {
  ColumnChoice choice;
  if (text.empty()) return choice;
  for (const std::string& each : split_at(text, ',')) {
    const std::string part(trimmed(each));
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals + 1 == part.size())
      throw UsageError("--columns: '" + shown_word(part) + "' is not FIELD=COLUMN, such as x=E");
    const auto field = cloud_field(part.substr(0, equals));
    if (!field)
      throw UsageError("--columns: '" + shown_word(part.substr(0, equals)) + "' is not one of " +
                       joined(field_names(), ", ", &FieldNames::name));
    if (is_chosen(choice, *field))
      throw UsageError("--columns gives " + std::string(name_of(*field)) + " twice");
    choice.emplace_back(*field, part.substr(equals + 1));
    require_position_fields(*field, choice.back().second);
  }
  return choice;
}

bool is_chosen(const ColumnChoice& choice, CloudField field) {
  return std::ranges::any_of(choice, [field](const auto& chosen) { return chosen.first == field; });
}

CloudTable cloud_columns(const std::vector<std::string>& names, const ColumnChoice& choice,
                         const std::string& file) {
  CloudTable table = matched(names, choice, file);
  if (!has_position(table.columns)) {
    const char* const missing = !table.columns[0] ? "x" : !table.columns[1] ? "y" : "z";
    throw FormatError(file + ": no column is recognised as " + missing + "; it has " + first_names(names) +
                      ": name it with --columns x=...,y=...,z=...");
  }
  check_units(table, names, choice, file);
  require_like_units(table, names, file);
  note_lowest_mode(table, names);
  return table;
}

CloudTable numbered_columns(const std::vector<bool>& is_number, const ColumnChoice& choice,
                            const std::string& file) {
  std::vector<std::string> numbers;
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < is_number.size(); ++i) {
    numbers.push_back(std::to_string(i + 1));
    if (is_number[i]) usable.push_back(i);
  }
  CloudTable table;
  take_choice(table.columns, numbers, choice, file);
  for (std::size_t i = 0; i < 3; ++i)
    if (!table.columns[i] && i < usable.size()) table.columns[i] = usable[i];
  if (has_position(table.columns)) return table;
  const std::size_t count = usable.size();
  throw FormatError(file + ": has " + std::to_string(count) + (count == 1 ? " column" : " columns") +
                    (count < is_number.size() ? " of numbers" : "") + ", but a point has x, y and z");
}

bool names_a_cloud(const std::vector<std::string>& names, const ColumnChoice& choice) {
  try {
    return has_position(matched(names, choice, "").columns);
  } catch (const Error&) {
    return false;
  }
}

bool names_a_field(const std::vector<std::string>& names) {
  const Readings readings = read_names(names);
  const auto is_usual = [&](const FieldNames& field) {
    return std::ranges::any_of(readings, [&](const std::vector<NameReading>& name) {
      return std::ranges::find(field.usual, name.front().plain) != field.usual.end();
    });
  };
  return std::ranges::any_of(field_names(), is_usual);
}

}  // namespace landfall
