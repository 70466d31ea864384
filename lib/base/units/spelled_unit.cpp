// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D371
#include "base/units/spelled_unit.h"

#include <udunits2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <string_view>

#include "base/core/error.h"
#include "base/text/characters.h"
#include "base/text/shown_text.h"

namespace landfall {
namespace {

struct Unit {
  const char* name;
  double metres;
};

constexpr double kUsSurveyFoot_m = 1200.0 / 3937.0;

/// Names that UDUNITS lacks or reads in another sense, as normalised() writes them.
constexpr Unit kOwnNames[] = {{"m", 1},
                              {"metre", 1},
                              {"meter", 1},
                              {"km", 1000},
                              {"ft", 0.3048},
                              {"foot", 0.3048},
                              {"feet", 0.3048},
                              {"internationalfoot", 0.3048},
                              {"internationalfeet", 0.3048},
                              {"ftus", kUsSurveyFoot_m},
                              {"usft", kUsSurveyFoot_m},
                              {"footus", kUsSurveyFoot_m},
                              {"ussurveyft", kUsSurveyFoot_m},
                              {"ussurveyfoot", kUsSurveyFoot_m},
                              {"ussurveyfeet", kUsSurveyFoot_m},
                              {"surveyfoot", kUsSurveyFoot_m},
                              {"surveyfeet", kUsSurveyFoot_m},
                              {"footussurvey", kUsSurveyFoot_m},
                              {"feetussurvey", kUsSurveyFoot_m}};

/// In lower case, without blanks, underscores, hyphens and points, and without the s of a plural.
std::string normalised(const std::string& text) {
  std::string name;
  for (const char c : lower_case(text))
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
  if (name.size() > 2 && name.back() == 's' && name != "ftus" && name != "footus") name.pop_back();
  return name;
}

/// Without the blanks, brackets and quotes around it.
std::string without_brackets(std::string_view text) {
  constexpr std::string_view kAround = " \t\r\n<>[]\"'";
  const std::size_t first = text.find_first_not_of(kAround);
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(kAround) - first + 1));
}

/// "m above MSL" and "metres (NAVD88)" without the words that name the datum.
std::string without_datum(const std::string& text) {
  constexpr std::array<const char*, 14> kBegins = {"(",         ",",      " above",  " over", " below",
                                                   " relative", " w.r.t", " wrt",    " from", " referred",
                                                   " height",   " elev",  " to the", " in "};
  const std::string folded = lower_case(text);
  std::size_t end = text.size();
  for (const char* const begin : kBegins) end = std::min(end, folded.find(begin));
  return without_brackets(std::string_view(text).substr(0, end));
}

/// The database of UDUNITS, read at the first unit that is not an own name.
class Udunits {
 public:
  Udunits() {
    ut_set_error_message_handler(ut_ignore);
    system_.reset(ut_read_xml(nullptr));
    const char* const path = std::getenv("UDUNITS2_XML_PATH");
    if (!system_)
      throw FormatError("UDUNITS cannot read its database of units: " +
                        (path != nullptr ? "unset UDUNITS2_XML_PATH=" + abbreviated(path) + ", or correct it"
                                         : std::string("install libudunits2-data")));
    metre_ = unit("meter");
    radian_ = unit("radian");
    second_ = unit("second");
  }

  [[nodiscard]] SpelledUnit read(const std::string& text) const {
    const Handle parsed = unit(text.c_str());
    if (!parsed) return {};
    return {.metres = factor(parsed, metre_),
            .radians = factor(parsed, radian_),
            .seconds = factor(parsed, second_)};
  }

 private:
  struct Free {
    void operator()(ut_system* system) const { ut_free_system(system); }
    void operator()(ut_unit* unit) const { ut_free(unit); }
    void operator()(cv_converter* converter) const { cv_free(converter); }
  };
  using Handle = std::unique_ptr<ut_unit, Free>;

  [[nodiscard]] Handle unit(const char* text) const { return Handle(ut_parse(system_.get(), text, UT_UTF8)); }

  /// 0 where the units do not convert, or not by a factor alone.
  static double factor(const Handle& from, const Handle& to) {
    const std::unique_ptr<cv_converter, Free> converter(ut_get_converter(from.get(), to.get()));
    if (!converter || cv_convert_double(converter.get(), 0) != 0) return 0;
    const double result = cv_convert_double(converter.get(), 1);
    return std::isfinite(result) && result > 0 ? result : 0;
  }

  std::unique_ptr<ut_system, Free> system_;
  Handle metre_;
  Handle radian_;
  Handle second_;
};

SpelledUnit plain_unit(const std::string& text) {
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0 || c > 127; };
  if (std::ranges::none_of(text, is_letter)) return {};  // a number is an angle in radians to UDUNITS
  if (lower_case(text) == "deg") return {.radians = std::numbers::pi / 180};
  const auto own = std::ranges::find_if(kOwnNames, [&](const Unit& unit) { return text == unit.name; });
  if (own != std::end(kOwnNames)) return {own->metres};
  static const Udunits udunits;
  SpelledUnit unit = udunits.read(text);
  if (unit.is_known()) return unit;
  const std::string name = normalised(text);
  for (const Unit& known : kOwnNames)
    if (name == known.name) return {known.metres};
  if (lower_case(text) == "mm") return {};  // "MM": millimetres or megametres
  return udunits.read(lower_case(text));
}

}  // namespace

SpelledUnit spelled_unit(const std::string& text) {
  const std::string spelled = without_brackets(text);
  SpelledUnit unit = plain_unit(spelled);
  if (unit.is_known()) return unit;
  const std::string length = without_datum(spelled);
  if (length.empty() || length.size() == spelled.size()) return {};
  unit = plain_unit(length);
  if (!(unit.metres > 0)) return {};
  const std::string datum = lower_case(spelled.substr(length.size()));
  if (datum.find("survey") != std::string::npos) return {};  // another foot
  unit.downwards = datum.find("below") != std::string::npos || datum.find("downward") != std::string::npos;
  return unit;
}

bool says_no_unit(const std::string& text) {
  const std::string name = normalised(text);
  const bool has_sign = std::ranges::any_of(text, [](unsigned char c) { return c > 127; });  // a degree sign
  return (name.empty() && !has_sign) || name == "1" || name == "none" || name == "unknown" || name == "na" ||
         name == "unk" || name == "null" || name == "dimensionless" || name == "unspecified";
}

}  // namespace landfall
