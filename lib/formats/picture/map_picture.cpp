// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D241, D242
#include "formats/picture/map_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "formats/picture/pixel_map.h"
#include "formats/picture/text_image.h"

namespace landfall {
namespace {

constexpr Rgb kPaper = {255, 255, 255};
constexpr Rgb kInk = {30, 30, 30};
constexpr std::int64_t kEnlargeTo = 600;
constexpr std::int64_t kMinSide = 240;  ///< of the frame, so that labels have room
constexpr double kMinRange = 1e-9;      ///< smaller ranges are rounding errors
constexpr std::int64_t kTick = 6;
constexpr std::int64_t kGap = 8;
constexpr std::int64_t kBarWidth = 22;

std::string rounded_text(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value == 0 ? 0.0 : value);  // no "-0"
  return text.data();
}

std::vector<double> finite_values(const PixelMap& map) {
  std::vector<double> values;
  std::copy_if(map.values.begin(), map.values.end(), std::back_inserter(values),
               [](double v) { return std::isfinite(v); });
  return values;
}

double quantile(std::vector<double>& values, double q) {
  const auto rank = static_cast<std::ptrdiff_t>(std::llround(q * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

/// The upper end of a scale that begins at zero or is symmetric about it.
double magnitude_bound(std::vector<double> values, const MapStyle& style) {
  for (double& value : values) value = std::abs(value);
  const double bound = std::max(quantile(values, style.cut ? 1 - dictionary::kOutliers : 1), kMinRange);
  const double limit = style.limit ? dictionary::kLimitInside * *style.limit : 0;
  return limit <= dictionary::kLimitNear * bound ? std::max(bound, limit) : bound;
}

/// The positions of all elements, in image pixels.
struct Layout {
  std::int64_t zoom;
  std::int64_t left;
  std::int64_t top;
  std::int64_t map_width;  ///< of the map itself
  std::int64_t map_height;
  std::int64_t frame_width;  ///< of its frame, which may be larger
  std::int64_t frame_height;

  [[nodiscard]] std::int64_t right() const { return left + frame_width; }
  [[nodiscard]] std::int64_t bottom() const { return top + frame_height; }
};

Layout layout_of(const PixelMap& map) {
  Layout layout{};
  layout.zoom = std::max<std::int64_t>(1, kEnlargeTo / std::max(map.rows, map.cols));
  layout.left = 120;
  layout.top = 3 * text_height() + 5 * kGap;
  layout.map_width = map.cols * layout.zoom;
  layout.map_height = map.rows * layout.zoom;
  layout.frame_width = std::max(layout.map_width, kMinSide);
  layout.frame_height = std::max(layout.map_height, kMinSide);
  return layout;
}

struct Rectangle {
  std::int64_t top;
  std::int64_t left;
  std::int64_t height;
  std::int64_t width;
};

void fill(RgbImage& image, const Rectangle& r, Rgb color) {
  for (std::int64_t row = r.top; row < r.top + r.height; ++row)
    for (std::int64_t col = r.left; col < r.left + r.width; ++col) image.set(row, col, color);
}

/// Draws a line one pixel wide around the rectangle.
void outline(RgbImage& image, const Rectangle& r) {
  fill(image, {r.top - 1, r.left - 1, 1, r.width + 2}, kInk);
  fill(image, {r.top + r.height, r.left - 1, 1, r.width + 2}, kInk);
  fill(image, {r.top - 1, r.left - 1, r.height + 2, 1}, kInk);
  fill(image, {r.top - 1, r.left + r.width, r.height + 2, 1}, kInk);
}

Rgb shaded(Rgb color, double shade) {
  const double light = std::clamp(0.25 + 0.75 * shade, 0.0, 1.25);
  const auto part = [light](std::uint8_t c) {
    return static_cast<std::uint8_t>(std::min(255L, std::lround(c * light)));
  };
  return {part(color.r), part(color.g), part(color.b)};
}

/// The colour of a finite value.
Rgb flat_color(double value, const MapStyle& style, const std::array<double, 2>& range) {
  if (!style.classes.empty()) return rgb_of(style.classes.at(static_cast<std::size_t>(value)).color);
  return color_of((value - range[0]) / (range[1] - range[0]), style.colors);
}

void draw_map(RgbImage& image, const PixelMap& map, const MapStyle& style, const Layout& layout,
              const std::array<double, 2>& range) {
  const std::vector<double> shades = style.relief ? hillshade(map) : std::vector<double>();
  for (std::int64_t row = 0; row < map.rows; ++row)
    for (std::int64_t col = 0; col < map.cols; ++col) {
      const double value = map.at(row, col);
      Rgb color = rgb_of(kNoValueColor);
      if (std::isfinite(value)) {
        color = flat_color(value, style, range);
        if (style.relief) color = shaded(color, shades[static_cast<std::size_t>(row * map.cols + col)]);
      }
      fill(image, {layout.top + row * layout.zoom, layout.left + col * layout.zoom, layout.zoom, layout.zoom},
           color);
    }
  outline(image, {layout.top, layout.left, layout.map_height, layout.map_width});
}

void draw_axes(RgbImage& image, const PixelMap& map, const Layout& layout) {
  const double pixels_per_m = static_cast<double>(layout.zoom) / map.pixel_m;
  const double width_m = static_cast<double>(map.cols) * map.pixel_m;
  const double height_m = static_cast<double>(map.rows) * map.pixel_m;
  const std::int64_t bottom = layout.top + layout.map_height;
  for (const double x : ticks(map.west_m, map.west_m + width_m, static_cast<int>(layout.map_width / 110))) {
    const std::int64_t col = layout.left + std::llround((x - map.west_m) * pixels_per_m);
    fill(image, {bottom, col, kTick, 1}, kInk);
    const std::string text = rounded_text(x, 8);
    draw_text(image, {bottom + kTick + kGap / 2, col - text_width(text) / 2}, text, kInk);
  }
  for (const double y :
       ticks(map.north_m - height_m, map.north_m, static_cast<int>(layout.map_height / 80))) {
    const std::int64_t row = layout.top + std::llround((map.north_m - y) * pixels_per_m);
    fill(image, {row, layout.left - kTick, 1, kTick}, kInk);
    const std::string text = rounded_text(y, 8);
    draw_text(image, {row - text_height() / 2, layout.left - kTick - kGap / 2 - text_width(text)}, text,
              kInk);
  }
  const std::string x_axis = "x (m)";
  draw_text(
      image,
      {bottom + kTick + text_height() + kGap, layout.left + (layout.map_width - text_width(x_axis)) / 2},
      x_axis, kInk);
  draw_text(image, {layout.top - text_height() - 2 * kGap, layout.left - text_width("y (m)") - kGap}, "y (m)",
            kInk);
}

/// The limits that the scale of an error shows.
std::vector<double> limits_on(const MapStyle& style, const std::array<double, 2>& range) {
  std::vector<double> limits;
  if (style.limit && *style.limit < range[1]) limits.push_back(*style.limit);
  if (style.limit && -*style.limit > range[0]) limits.push_back(-*style.limit);
  return limits;
}

/// A sample of a colour and its name.
void draw_sample(RgbImage& image, std::int64_t top, std::int64_t left, const MapClass& item) {
  const Rectangle swatch{top, left, text_height() - 2, kBarWidth};
  fill(image, swatch, rgb_of(item.color));
  outline(image, swatch);
  draw_text(image, {top - 1, left + kBarWidth + kGap}, item.name, kInk);
}

const MapClass& no_value() {
  static const MapClass item{"no value", kNoValueColor};
  return item;
}

void draw_bar(RgbImage& image, const MapStyle& style, const Layout& layout,
              const std::array<double, 2>& range) {
  const Rectangle bar{layout.top, layout.right() + 3 * kGap, layout.frame_height - 2 * text_height(),
                      kBarWidth};
  const auto last = static_cast<double>(bar.height - 1);
  for (std::int64_t i = 0; i < bar.height; ++i)
    fill(image, {bar.top + i, bar.left, 1, bar.width},
         color_of(1 - static_cast<double>(i) / last, style.colors));
  outline(image, bar);
  for (const double value : ticks(range[0], range[1], static_cast<int>(bar.height / 70))) {
    const double part = (range[1] - value) / (range[1] - range[0]);
    const std::int64_t row = bar.top + std::llround(part * last);
    fill(image, {row, bar.left + bar.width, 1, kTick}, kInk);
    draw_text(image, {row - text_height() / 2, bar.left + bar.width + kTick + kGap / 2},
              rounded_text(value, 8), kInk);
  }
  for (const double limit : limits_on(style, range)) {
    const std::int64_t row = bar.top + std::llround((range[1] - limit) / (range[1] - range[0]) * last);
    fill(image, {row - 2, bar.left - kGap, 5, bar.width + kGap}, kPaper);
    fill(image, {row - 1, bar.left - kGap, 3, bar.width + kGap}, kInk);
  }
  draw_sample(image, layout.bottom() - text_height(), bar.left, no_value());
}

/// The classes that a legend lists: those of the style, the last first, and "no value" if a pixel has none.
std::vector<MapClass> listed_classes(const PixelMap& map, const MapStyle& style) {
  std::vector<MapClass> classes(style.classes.rbegin(), style.classes.rend());
  if (finite_values(map).size() < map.values.size()) classes.push_back(no_value());
  return classes;
}

void draw_legend(RgbImage& image, const std::vector<MapClass>& classes, const Layout& layout) {
  std::int64_t top = layout.top;
  for (const MapClass& item : classes) {
    draw_sample(image, top, layout.right() + 3 * kGap, item);
    top += text_height() + kGap;
  }
}

/// From the frame to the right border of the picture.
std::int64_t right_width(const std::vector<MapClass>& classes) {
  std::int64_t width = 190;  // of a colour bar and its labels
  for (const MapClass& item : classes) width = std::max(width, 5 * kGap + kBarWidth + text_width(item.name));
  return width;
}

std::string range_text(const PixelMap& map, const MapStyle& style, const std::array<double, 2>& range) {
  const std::vector<double> values = finite_values(map);
  std::string text = "no value anywhere";
  if (!values.empty()) {
    const auto [minimum, maximum] = std::minmax_element(values.begin(), values.end());
    text = rounded_text(*minimum, 4) + " to " + rounded_text(*maximum, 4);
    if (*minimum < range[0] || *maximum > range[1])
      text += ", colours end at " + rounded_text(range[0], 4) + " and " + rounded_text(range[1], 4);
  }
  if (style.limit)
    text += std::string(", limit ") + (style.colors == Colors::error ? "\u00b1" : "") +
            rounded_text(*style.limit, 4);
  return text;
}

void draw_titles(RgbImage& image, const MapStyle& style, const std::string& second) {
  const std::string unit = style.unit.empty() || style.unit == "1" ? "" : " (" + style.unit + ")";
  draw_text(image, {kGap, kGap}, style.title + unit, kInk);
  draw_text(image, {2 * kGap + text_height(), kGap}, second, kInk);
}

}  // namespace

std::array<double, 2> color_range(const PixelMap& map, const MapStyle& style) {
  std::vector<double> values = finite_values(map);
  if (values.empty()) return {0, 1};
  if (style.colors == Colors::error || style.from_zero) {
    const double high = magnitude_bound(std::move(values), style);
    return {style.colors == Colors::error ? -high : 0, high};
  }
  double low = quantile(values, 0);
  double high = quantile(values, 1);
  const double max_low = quantile(values, dictionary::kOutliers);
  const double max_high = quantile(values, 1 - dictionary::kOutliers);
  if (style.cut && max_high > max_low && high - low > 2 * (max_high - max_low)) {
    low = max_low;
    high = max_high;
  }
  if (high - low > std::max(kMinRange, 1e-12 * std::max(std::abs(low), std::abs(high)))) return {low, high};
  const double half = low == 0 ? 0.5 : std::abs(low) / 2;
  return {low - half, low + half};
}

std::vector<double> ticks(double low, double high, int count) {
  constexpr double kRounding = 1e-9;  // of a step: 3 x 0.1 exceeds 0.3
  const double rough = (high - low) / std::max(count, 2);
  if (!(rough > 0) || !std::isfinite(rough)) return {};
  const double power = std::pow(10, std::floor(std::log10(rough)));
  double step = power;
  for (const double factor : {1.0, 2.0, 5.0, 10.0})
    if (step < rough * (1 - kRounding)) step = factor * power;
  std::vector<double> result;
  const double first = std::ceil(low / step - kRounding);
  const double last = std::floor(high / step + kRounding);
  const double decimals = std::pow(10, std::max(0.0, 1 - std::floor(std::log10(step))));
  for (double i = 0; i <= last - first; ++i)
    result.push_back(std::round((first + i) * step * decimals) / decimals);
  return result;
}

RgbImage map_picture(const PixelMap& map, const MapStyle& style) {
  const Layout layout = layout_of(map);
  const bool has_classes = !style.classes.empty();
  const auto range = has_classes ? std::array<double, 2>{} : color_range(map, style);
  const auto legend = has_classes ? listed_classes(map, style) : std::vector<MapClass>();
  RgbImage image(static_cast<std::size_t>(layout.right() + right_width(legend)),
                 static_cast<std::size_t>(layout.bottom() + 2 * text_height() + 4 * kGap), kPaper);
  draw_map(image, map, style, layout, range);
  draw_axes(image, map, layout);
  if (has_classes)
    draw_legend(image, legend, layout);
  else
    draw_bar(image, style, layout, range);
  draw_titles(
      image, style,
      has_classes ? "pixels of " + rounded_text(map.pixel_m, 4) + " m" : range_text(map, style, range));
  return image;
}

}  // namespace landfall
