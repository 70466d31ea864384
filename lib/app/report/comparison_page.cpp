// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/comparison_page.h"

#include <algorithm>
#include <utility>

#include "app/report/escape.h"
#include "base/dictionary/layers.h"
#include "base/dictionary/tables/requirements.h"

namespace landfall::html_report {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// The bits of a layer of flags, or 2^value of one of classes; 0 where there is no class.
Grid<std::int32_t> class_bits(const Grid<double>& values, bool are_classes) {
  Grid<std::int32_t> bits(values.spec());
  for (std::size_t i = 0; i < bits.spec().size(); ++i) {
    const double value = values.values()[i];
    if (are_classes ? value >= 0 && value < 8 : value >= 0)
      bits.values()[i] = are_classes ? 1 << static_cast<int>(value) : static_cast<std::int32_t>(value);
  }
  return bits;
}

std::int64_t count_of(const Grid<std::int32_t>& bits, std::int64_t bit) {
  return std::ranges::count_if(bits.values(), [&](std::int32_t value) { return (value & bit) != 0; });
}

std::vector<LayerClass> classes_of(const ReportLayer& layer, const Grid<std::int32_t>& bits) {
  std::vector<LayerClass> classes;
  if (layer.style == Style::flags)
    for (const dictionary::FailFlag& flag : dictionary::kFailFlags)
      classes.push_back({flag.bit, flag.text, flag.color, count_of(bits, flag.bit)});
  else
    for (const dictionary::PlaceClass& place : dictionary::place_classes(layer.name)) {
      const std::int64_t bit = std::int64_t{1} << place.value;
      classes.push_back({bit, place.name, place.color, count_of(bits, bit)});
    }
  return classes;
}

ReportLayer layer_of(ReportLayer layer, const Grid<double>& values, std::int64_t factor) {
  if (layer.style != Style::flags && layer.style != Style::classes)
    return reduced_layer(layer, values, factor);
  const Grid<std::int32_t> bits = class_bits(values, layer.style == Style::classes);
  layer.classes = classes_of(layer, bits);
  return reduced_layer(layer, bits, factor);
}

ReportLayer difference_of(const ReportLayer& layer, const Grid<double>& a, const Grid<double>& b,
                          std::int64_t factor) {
  Grid<double> difference(a.spec());
  for (std::size_t i = 0; i < a.spec().size(); ++i) difference.values()[i] = b.values()[i] - a.values()[i];
  ReportLayer result{layer.name, layer.title, layer.unit, Style::signed_error, Rule::extreme};
  result.quantity = "B \u2212 A";
  return reduced_layer(std::move(result), difference, factor);
}

std::string answer_html(const OrderedJson& answer) {
  if (!answer.is_object()) return "<p>Nothing judges files of this kind; the differences are below.</p>";
  std::string text = "<ul id=\"answer-points\">\n";
  for (const OrderedJson& point : answer["points"])
    text += "<li data-change=\"" + html_text(point["change"].get<std::string>()) + "\"><b>" +
            html_text(point["name"].get<std::string>()) +
            "</b>: " + html_text(point["text"].get<std::string>()) + "</li>\n";
  text += "</ul>\n";
  for (const OrderedJson& note : answer["notes"])
    text += "<p>Note: " + html_text(note.get<std::string>()) + ".</p>\n";
  return text;
}

std::string answer_banner_html(const OrderedJson& answer) {
  if (!answer.is_object()) return "";
  const std::string conclusion = answer["conclusion"].get<std::string>();
  const char* const style = conclusion == "better" ? "pass" : conclusion == "worse" ? "fail" : "unjudged";
  return std::string("<div class=\"banner ") + style + "\" id=\"verdict\">" +
         html_text(answer["sentence"].get<std::string>()) + "</div>";
}

std::string side_html(const char* name, const OrderedJson& side) {
  return std::string(name) + " " + html_text(side["file"].get<std::string>()) + " <code>" +
         html_text(side["file_id"].get<std::string>()) + "</code>";
}

}  // namespace

void ComparisonReport::take(const std::string& kind, const ContentInfo& layer, const Grid<double>& a,
                            const Grid<double>& b) {
  const dictionary::Layer* const words = dictionary::find_layer(kind, layer.name);
  if (words == nullptr || !words->compared) return;
  grid_ = a.spec();
  const std::int64_t factor = reduction_factor(a.spec(), kMaxCells);
  const ReportLayer empty = described(kind.c_str(), layer.name);
  const std::string group = empty.title + " (" + layer.name + ")";
  titles_.push_back(group);
  std::vector<std::pair<const char*, ReportLayer>> three = {{"A", layer_of(empty, a, factor)},
                                                            {"B", layer_of(empty, b, factor)}};
  if (!is_class(layer)) three.emplace_back("B - A", difference_of(empty, a, b, factor));
  for (auto& [side, shown] : three) {
    shown.name += std::string(" ") + side;
    shown.group = group;
    layers_.push_back(std::move(shown));
  }
}

std::string ComparisonReport::page(const OrderedJson& comparison) const {
  const OrderedJson answer = comparison.value("answer", OrderedJson());
  Packer packer;
  OrderedJson list = OrderedJson::array();
  for (const ReportLayer& layer : layers_)
    list.push_back(packer.add(layer, "layer" + std::to_string(list.size())));
  ReportData data;
  data.values = {
      {"grid", grid_ ? grid_json(*grid_, reduction_factor(*grid_, kMaxCells)) : OrderedJson(nullptr)},
      {"region", OrderedJson::object()},
      {"colors", colors_json()},
      {"layers", std::move(list)},
      {"groups", titles_},
      {"comparison", comparison}};
  data.packed = packer.pack();
  const std::string title = "Two files of kind " + comparison["kind"].get<std::string>() + " compared";
  return page_html("comparison.html", {{"title", html_text(title)},
                                       {"subtitle", "<p class=\"note\">" + side_html("A:", comparison["a"]) +
                                                        "<br>" + side_html("B:", comparison["b"]) + "</p>"},
                                       {"banner", answer_banner_html(answer)},
                                       {"answer", answer_html(answer)},
                                       {"data", data_html(data)}});
}

}  // namespace landfall::html_report
