#include "film/false_colour.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/printed.hpp"
#include "film/display.hpp"

namespace vitrum {
namespace {

constexpr glm::vec3 not_finite_colour{1, 0, 1}, paper{0.18f, 0.18f, 0.18f}, ink{0.95f, 0.95f, 0.95f};

constexpr int glyph_width = 3, glyph_height = 5;

struct Glyph {
  char character;
  std::array<uint8_t, glyph_height> rows;  ///< from the top; bit 2 is the left column
};

constexpr std::array<Glyph, 14> font{{{'0', {7, 5, 5, 5, 7}},
                                      {'1', {2, 6, 2, 2, 7}},
                                      {'2', {7, 1, 7, 4, 7}},
                                      {'3', {7, 1, 3, 1, 7}},
                                      {'4', {5, 5, 7, 1, 1}},
                                      {'5', {7, 4, 7, 1, 7}},
                                      {'6', {7, 4, 7, 5, 7}},
                                      {'7', {7, 1, 1, 2, 2}},
                                      {'8', {7, 5, 7, 5, 7}},
                                      {'9', {7, 5, 7, 1, 7}},
                                      {'.', {0, 0, 0, 0, 2}},
                                      {'e', {0, 7, 7, 4, 7}},
                                      {'+', {0, 2, 7, 2, 0}},
                                      {'-', {0, 0, 7, 0, 0}}}};

/// Draws in the screen's values; what lies outside of the picture is left out.
class Canvas {
 public:
  Canvas(int width, int height)
      : picture_{width, height, std::vector<glm::vec3>(size_t(width) * size_t(height), paper)} {}

  void fill(int left, int top, int width, int height, const glm::vec3& colour) {
    for (int y = std::max(0, top); y < std::min(top + height, picture_.height); ++y) {
      for (int x = std::max(0, left); x < std::min(left + width, picture_.width); ++x) {
        picture_.pixels[size_t(y) * size_t(picture_.width) + size_t(x)] = colour;
      }
    }
  }
  /// `dot` is the size of a glyph's dots in pixels.
  void write(int left, int top, int dot, std::string_view text) {
    for (const char character : text) {
      const auto glyph =
          std::find_if(font.begin(), font.end(), [=](const Glyph& g) { return g.character == character; });
      assert(glyph != font.end());
      for (int row = 0; row < glyph_height; ++row) {
        for (int column = 0; column < glyph_width; ++column) {
          if (glyph->rows[size_t(row)] >> (glyph_width - 1 - column) & 1) {
            fill(left + column * dot, top + row * dot, dot, dot, ink);
          }
        }
      }
      left += (glyph_width + 1) * dot;
    }
  }
  /// The picture, in linear values.
  Picture linear() && {
    for (glm::vec3& colour : picture_.pixels) {
      for (int c = 0; c < 3; ++c) colour[c] = float(srgb_decode(colour[c]));
    }
    return std::move(picture_);
  }

 private:
  Picture picture_;
};

std::string label(double value) { return printed("%.3g", value); }

/// 1, 2 or 5 times a power of ten, such that 2.5 to 6.25 of it make up `scale`.
double tick_step(double scale) {
  const double most = scale / 2.5, power = std::pow(10.0, std::floor(std::log10(most)));
  return power * (most >= 5.0 * power ? 5.0 : most >= 2.0 * power ? 2.0 : 1.0);
}

}  // namespace

glm::vec3 false_colour(double t) {
  constexpr double pi = 3.14159265358979323846, start = 0.5, rotations = -1.5;
  const double lightness = std::clamp(t, 0.0, 1.0);
  const double angle = 2.0 * pi * (start / 3.0 + 1.0 + rotations * lightness);
  const double amplitude = 0.5 * lightness * (1.0 - lightness), cosine = std::cos(angle), sine = std::sin(angle);
  const glm::dvec3 colour{lightness + amplitude * (-0.14861 * cosine + 1.78277 * sine),
                          lightness + amplitude * (-0.29227 * cosine - 0.90649 * sine),
                          lightness + amplitude * 1.97294 * cosine};
  return glm::clamp(glm::vec3(colour), 0.0f, 1.0f);
}

double false_colour_scale(std::span<const float> values) {
  std::vector<float> positive;
  std::copy_if(values.begin(), values.end(), std::back_inserter(positive),
               [](float value) { return value > 0.0f && std::isfinite(value); });
  if (positive.empty()) return 1.0;
  const auto high = positive.begin() + std::ptrdiff_t(positive.size() - 1 - positive.size() / 100);
  std::nth_element(positive.begin(), high, positive.end());
  const double power = std::pow(10.0, std::floor(std::log10(double(*high))) - 1.0);
  return power * std::ceil(double(*high) / power);
}

Picture false_colour_picture(std::span<const float> values, int width, int height, double scale) {
  assert(values.size() == size_t(width) * size_t(height) && scale > 0.0);
  // All lengths follow from the size of the letters' dots, which grows with the picture.
  const int dot = std::max(2, height / 200), margin = 4 * dot, bar_width = 8 * dot, tick = 2 * dot;
  constexpr int longest_label = 9;  // "1.23e-123"
  const int rows = std::max(height, 60 * dot), bar_left = width + margin, bar_height = rows - 2 * margin;
  const int label_left = bar_left + bar_width + 2 * tick;
  Canvas canvas(label_left + longest_label * (glyph_width + 1) * dot, rows);

  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double value = values[size_t(y) * size_t(width) + size_t(x)];
      canvas.fill(x, y, 1, 1, std::isfinite(value) ? false_colour(value / scale) : not_finite_colour);
    }
  }
  for (int y = 0; y < bar_height; ++y) {
    canvas.fill(bar_left, margin + y, bar_width, 1, false_colour(1.0 - double(y) / (bar_height - 1)));
  }
  const auto mark = [&](double value) {
    const int y = margin + int(std::lround((1.0 - value / scale) * (bar_height - 1)));
    canvas.fill(bar_left + bar_width, y, tick, 1, ink);
    canvas.write(label_left, y - glyph_height * dot / 2, dot, label(value));
  };
  // A tick so near the bar's end that their numbers would touch gives way to the end's.
  const double nearest = scale * (1.0 - double((glyph_height + 2) * dot) / bar_height), step = tick_step(scale);
  for (int i = 0; i * step <= nearest; ++i) mark(i * step);
  mark(scale);
  return std::move(canvas).linear();
}

}  // namespace vitrum
