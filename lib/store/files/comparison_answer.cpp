// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D468
#include "store/files/comparison_answer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/dictionary/tables/requirements.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"
#include "base/text/split_text.h"

namespace landfall {
namespace {

using OrderedJson = nlohmann::ordered_json;
using Value = std::optional<double>;

/// A smaller change counts as none.
constexpr double kSameShare = 0.01;
/// The largest McNemar p of a difference between draws.
constexpr double kSignificant = 0.05;

Value number_in(const OrderedJson& json) {
  return json.is_number() ? Value(json.get<double>()) : std::nullopt;
}

/// The number at a dotted path.
Value number_of_path(const OrderedJson& json, const std::string& path) {
  const OrderedJson* at = &json;
  for (const std::string& part : split_at(path, '.')) {
    const auto found = at->is_object() ? at->find(part) : at->end();
    if (found == at->end()) return std::nullopt;
    at = &*found;
  }
  return number_in(*at);
}

/// The largest of the numbers at several paths, separated by spaces.
Value largest_at(const OrderedJson& json, const std::string& paths) {
  Value largest;
  for (const std::string& path : split_words(paths))
    if (const Value found = number_of_path(json, path)) largest = std::max(largest.value_or(*found), *found);
  return largest;
}

/// 1: b is better; -1: it is worse; 0: the change is small, or one of them is not known.
int sign_of(Value a, Value b, Value limit, bool larger_is_better) {
  if (!a || !b) return 0;
  const double size = std::max({std::abs(*a), std::abs(*b), std::abs(limit.value_or(0))});
  if (std::abs(*b - *a) <= kSameShare * size) return 0;
  return (*b > *a) == larger_is_better ? 1 : -1;
}

/// A number with the unit of its key: lengths in cm, fractions in per cent, bins.
std::string amount(std::string_view key, Value value) {
  if (!value) return "unknown";
  if (key.ends_with("_m")) return short_number(100 * *value) + " cm";
  if (key.ends_with("_frac")) return percent_text(*value);
  const std::string text =
      std::floor(*value) == *value ? grouped(static_cast<std::int64_t>(*value)) : short_number(*value);
  return text + (key.ends_with("_bins") ? " bins" : "");
}

/// "4.8 cm -> 6.1 cm (+1.3 cm)"; shares differ by percentage points.
std::string change_text(std::string_view key, Value a, Value b) {
  std::string text = amount(key, a) + " -> " + amount(key, b);
  if (!a || !b || *a == *b) return text;
  const std::string by =
      key.ends_with("_frac") ? short_number(100 * (*b - *a)) + " percentage points" : amount(key, *b - *a);
  return text + " (" + (*b > *a ? "+" : "") + by + ")";
}

/// The change of the share of its limit that a value uses up.
int share_sign(Value a, Value b, Value limit_a, Value limit_b, bool larger_is_better) {
  if (limit_a == limit_b) return sign_of(a, b, limit_b, larger_is_better);
  if (!a || !b || !(limit_a > 0.0) || !(limit_b > 0.0)) return 0;
  return sign_of(*a / *limit_a, *b / *limit_b, 1, larger_is_better);
}

std::string limit_text(std::string_view key, Value a, Value b) {
  return ", limit " + (a && b && *a != *b ? amount(key, a) + " -> " : "") + amount(key, b ? b : a);
}

/// The change from A to B of one requirement or number.
struct AnswerPoint {
  std::string name;
  int sign = 0;         ///< of a verdict that changes, of a failure, or of a number that nothing judges
  int margin_sign = 0;  ///< of a requirement that both meet
  std::string text;
  OrderedJson numbers = OrderedJson::object();
  bool is_known = true;  ///< whether the files tell the change
};

const char* change_word(const AnswerPoint& point, int sign) {
  return sign > 0 ? "better" : sign < 0 ? "worse" : point.is_known ? "same" : "unknown";
}

const char* verdict_of(const OrderedJson& requirement) {
  const OrderedJson pass = requirement.is_object() ? requirement.value("pass", OrderedJson()) : OrderedJson();
  return !pass.is_boolean() ? "not judged" : pass.get<bool>() ? "pass" : "FAIL";
}

/// The signs of a requirement by its verdicts, the value that is judged and that which uses up the limit.
void set_signs(AnswerPoint& point, const OrderedJson& a, const OrderedJson& b, bool at_least,
               int worst_sign) {
  const std::string_view in_a = verdict_of(a), in_b = verdict_of(b);
  point.numbers = {{"verdict_a", in_a}, {"verdict_b", in_b}};
  point.text = in_a == in_b ? std::string(in_a) + " in both" : std::string(in_a) + " -> " + std::string(in_b);
  point.is_known = in_a != "not judged" && in_b != "not judged";
  if (!point.is_known) return;
  if (in_a != in_b) {
    point.sign = in_b == "pass" ? 1 : -1;
  } else if (in_a == "pass") {
    point.margin_sign = worst_sign;
  } else {
    point.sign = sign_of(number_in(a["value"]), number_in(b["value"]), std::nullopt, at_least);
    if (point.sign == 0) point.sign = worst_sign;
  }
}

/// ", 0.4 % -> 0.7 % of all": the shares of footprints that are counted along each axis.
std::string shares_text(const dictionary::Requirement& words, Value value_a, Value value_b,
                        const OrderedJson& a, const OrderedJson& b) {
  const auto share = [&](Value value, const OrderedJson& file) -> Value {
    const Value bins = number_of_path(file["metrics"], "region.bin_count");
    const auto axes = static_cast<double>(std::string_view(words.footprints).size());
    return value && bins && *bins > 0 ? Value(*value / (*bins * axes)) : std::nullopt;
  };
  return ", " + amount("_frac", share(value_a, a)) + " -> " + amount("_frac", share(value_b, b)) + " of all";
}

/// A requirement of the dictionary. `a` and `b` describe the files.
AnswerPoint requirement_point(const dictionary::Requirement& words, const OrderedJson& in_a,
                              const OrderedJson& in_b, const OrderedJson& a, const OrderedJson& b) {
  AnswerPoint point{words.name, 0, 0, "", {}};
  const Value worst_a = largest_at(a["metrics"], words.worst);
  const Value worst_b = largest_at(b["metrics"], words.worst);
  const std::string limit_path = std::string("config.limits.") + words.worst_limit;
  const Value limit_a = number_of_path(a, limit_path), limit_b = number_of_path(b, limit_path);
  set_signs(point, in_a, in_b, words.at_least, share_sign(worst_a, worst_b, limit_a, limit_b, false));
  if (!in_a.is_object() || !in_b.is_object()) return point;
  const bool counts_footprints = words.unit == std::string_view("footprints");
  const std::string_view key = counts_footprints ? "" : words.value;
  const Value value_a = number_in(in_a["value"]), value_b = number_in(in_b["value"]);
  point.text += std::string("; ") + words.measured + ": " + change_text(key, value_a, value_b);
  if (counts_footprints) point.text += shares_text(words, value_a, value_b, a, b);
  point.numbers.update(OrderedJson{{"a", in_a["value"]}, {"b", in_b["value"]}});
  if (std::string_view(words.worst) == words.value) {
    point.text += limit_text(words.worst_limit, limit_a, limit_b);
    return point;
  }
  const char* const what = words.at_least ? "95th percentile " : "worst ";
  point.text += std::string("; ") + what + change_text("_m", worst_a, worst_b) +
                limit_text(words.worst_limit, limit_a, limit_b);
  point.numbers.update(OrderedJson{{"worst_a_m", worst_a ? OrderedJson(*worst_a) : OrderedJson(nullptr)},
                                   {"worst_b_m", worst_b ? OrderedJson(*worst_b) : OrderedJson(nullptr)}});
  return point;
}

/// A requirement of the user's own. Of one that judges other numbers in B than in A the change is unknown.
AnswerPoint own_point(const std::string& name, const OrderedJson& in_a, const OrderedJson& in_b) {
  AnswerPoint point{name, 0, 0, "", {}};
  const OrderedJson& any = in_b.is_object() ? in_b : in_a;
  const bool at_least = any.value("at_least", false);
  const auto number = [](const OrderedJson& side, const char* key) { return number_of_path(side, key); };
  const Value value_a = number(in_a, "value"), value_b = number(in_b, "value");
  const Value limit_a = number(in_a, "limit"), limit_b = number(in_b, "limit");
  set_signs(point, in_a, in_b, at_least, share_sign(value_a, value_b, limit_a, limit_b, at_least));
  const std::string metric = any.value("metric", "");
  if (in_a.is_object() && (in_a.value("metric", "") != metric || in_a.value("at_least", false) != at_least)) {
    point.sign = point.margin_sign = 0;
    point.is_known = false;
    point.text += "; A judges " + in_a.value("metric", "") + ", B " + metric;
    return point;
  }
  point.text +=
      "; " + metric + ": " + change_text(metric, value_a, value_b) + limit_text(metric, limit_a, limit_b);
  return point;
}

std::vector<AnswerPoint> requirement_points(const OrderedJson& comparison, const OrderedJson& a,
                                            const OrderedJson& b) {
  std::vector<AnswerPoint> points;
  for (const OrderedJson& entry : comparison.value("requirements", OrderedJson::array())) {
    const std::string name = entry["name"].get<std::string>();
    const auto* const words =
        std::ranges::find(dictionary::kRequirements, name, &dictionary::Requirement::name);
    points.push_back(words == dictionary::kRequirements.end() || !a.contains("metrics")
                         ? own_point(name, entry["a"], entry["b"])
                         : requirement_point(*words, entry["a"], entry["b"], a, b));
  }
  return points;
}

/// A number that nothing judges.
AnswerPoint number_point(const std::string& name, const std::string& key, Value a, Value b) {
  AnswerPoint point{name, sign_of(a, b, std::nullopt, false), 0, change_text(key, a, b),
                    OrderedJson::object()};
  point.numbers = {{"a", a ? OrderedJson(*a) : OrderedJson(nullptr)},
                   {"b", b ? OrderedJson(*b) : OrderedJson(nullptr)}};
  point.is_known = a.has_value() == b.has_value();
  return point;
}

std::vector<AnswerPoint> hazard_points(const OrderedJson& a, const OrderedJson& b) {
  std::vector<AnswerPoint> points;
  const auto add = [&](const char* name, const char* key, const char* share) {
    points.push_back(
        number_point(name, key, number_of_path(a["score"], key), number_of_path(b["score"], key)));
    points.back().text += share;
  };
  add("missed hazards", "missed_hazard_frac", " of the true hazards");
  add("false alarms", "false_alarm_frac", " of the safe places");
  add("unknown places", "counts.unknown", "");
  return points;
}

std::vector<AnswerPoint> dem_points(const OrderedJson& comparison) {
  std::vector<AnswerPoint> points;
  const OrderedJson errors = comparison.value("elevation_errors", OrderedJson());
  if (!errors.is_object()) return points;
  points.push_back(number_point("bins without an elevation", "", number_in(errors["empty_a"]),
                                number_in(errors["empty_b"])));
  points.push_back(number_point("rms elevation error of the bins that both have", "_m",
                                number_in(errors["rms_a_m"]), number_in(errors["rms_b_m"])));
  points.back().is_known = errors["rms_a_m"].is_number();
  return points;
}

std::vector<AnswerPoint> draw_points(const OrderedJson& comparison) {
  std::vector<AnswerPoint> points;
  for (const OrderedJson& pair : comparison.value("pairs", OrderedJson::array())) {
    const std::string name = pair["name"].get<std::string>();
    const auto count = [&](const char* key) { return pair[key].get<std::int64_t>(); };
    const std::int64_t all = count("both") + count("only_a") + count("only_b") + count("neither");
    if (all == 0 || name == "blind.safe") continue;  // a landing without the lidar says nothing of it
    AnswerPoint point{
        name, 0, 0, "", {{"a", count("both") + count("only_a")}, {"b", count("both") + count("only_b")}}};
    const double p = pair["mcnemar_p"].get<double>();
    if (p < kSignificant) point.sign = count("only_b") > count("only_a") ? 1 : -1;
    point.is_known = point.sign != 0 || count("only_a") + count("only_b") == 0;
    const OrderedJson& difference = pair["difference"];
    point.text = "passed by " + grouped(count("both") + count("only_a")) + " -> " +
                 grouped(count("both") + count("only_b")) + " of " + grouped(all) + " draws; difference " +
                 percent_text(difference["value"].get<double>()) + ", 95 % interval " +
                 percent_text(difference["low"].get<double>()) + " to " +
                 percent_text(difference["high"].get<double>()) + ", McNemar p " + short_number(p);
    points.push_back(std::move(point));
  }
  return points;
}

template <class Member, class Value>
std::string names_of(const std::vector<AnswerPoint>& points, Member member, Value wanted) {
  std::vector<std::string> names;
  for (const AnswerPoint& point : points)
    if (point.*member == wanted) names.push_back(point.name);
  return names.empty() ? "nothing" : joined(names, ", ");
}

/// The conclusion of the signs of one kind, and its sentence; none if all are 0.
std::optional<std::pair<std::string, std::string>> concluded(const std::vector<AnswerPoint>& points,
                                                             int AnswerPoint::*sign, const std::string& in) {
  const bool is_better = std::ranges::count(points, 1, sign) > 0;
  const bool is_worse = std::ranges::count(points, -1, sign) > 0;
  if (!is_better && !is_worse) return std::nullopt;
  const std::string word = is_better && is_worse ? "mixed" : is_better ? "better" : "worse";
  const std::string better = "better" + in + names_of(points, sign, 1);
  const std::string worse = "worse" + in + names_of(points, sign, -1);
  return std::pair(word,
                   "B is " + word + ": " + (word == "worse" ? worse + "; " + better : better + "; " + worse));
}

/// Keys that judge: with other ones two verdicts do not compare the maps alone.
OrderedJson notes_of(const OrderedJson& comparison) {
  OrderedJson notes = OrderedJson::array();
  std::vector<std::string> keys;
  for (const OrderedJson& entry : comparison["configuration"])
    if (const auto key = entry["key"].get<std::string>();
        entry["tool"] == "dem-eval" || entry["tool"] == "hazard-map" ||
        (entry["tool"] == "monte-carlo" && (key.starts_with("eval.") || key.starts_with("hazard."))))
      keys.push_back(key);
  if (!keys.empty()) notes.push_back("A and B are judged by different rules: " + joined(keys, ", "));
  if (comparison.contains("draws") && !comparison.contains("pairs"))
    notes.push_back("no draw of A has the seed and number of one of B: nothing is compared in pairs");
  return notes;
}

}  // namespace

OrderedJson answer_of(const OrderedJson& comparison, const OrderedJson& a, const OrderedJson& b) {
  const std::string kind = comparison["kind"].get<std::string>();
  if (kind == "terrain" || kind == "scan") return nullptr;
  std::vector<AnswerPoint> points = requirement_points(comparison, a, b);
  if (a.contains("score") && b.contains("score"))
    std::ranges::move(hazard_points(a, b), std::back_inserter(points));
  if (kind == "dem") std::ranges::move(dem_points(comparison), std::back_inserter(points));
  std::ranges::move(draw_points(comparison), std::back_inserter(points));
  auto conclusion = concluded(points, &AnswerPoint::sign, " in ");
  if (std::ranges::count(points, false, &AnswerPoint::is_known) > 0) {
    const std::string unknown = names_of(points, &AnswerPoint::is_known, false);
    if (conclusion) conclusion->second += "; unknown for " + unknown;
    if (!conclusion) conclusion.emplace("unknown", "whether B is better is unknown for " + unknown);
  }
  if (!conclusion) conclusion = concluded(points, &AnswerPoint::margin_sign, " by the margins of ");
  if (!conclusion && points.empty())
    conclusion.emplace("unknown", "whether B is better is unknown: no number of both is judged");
  if (!conclusion) conclusion.emplace("equal", "B is equal to A: no change of more than 1 %");
  OrderedJson json = {
      {"conclusion", conclusion->first}, {"sentence", conclusion->second}, {"points", OrderedJson::array()}};
  for (const AnswerPoint& point : points) {
    OrderedJson entry = {{"name", point.name},
                         {"change", change_word(point, point.sign)},
                         {"margin", change_word(point, point.margin_sign)}};
    entry.update(point.numbers);
    entry["text"] = point.text;
    json["points"].push_back(std::move(entry));
  }
  json["notes"] = notes_of(comparison);
  return json;
}

}  // namespace landfall
