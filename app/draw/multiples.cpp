#include "app/draw/multiples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "app/draw/sheet.hpp"
#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {
namespace {

constexpr double between_pictures = 16.0;
constexpr double row_of_text = 1.35 * sheet::text_size;

/// A picture as large as signs need, to be shown smaller.
Canvas drawn(const Multiple& multiple, const Box& frame) {
  constexpr Vec2 room{320.0, 320.0};
  const MechanismPicture picture{.poses = multiple.poses, .loads = false, .frame = frame};
  Stage stage(*multiple.scene, picture, room);
  draw_all(stage);
  return std::move(stage.canvas);
}

}  // namespace

std::string draw_multiples(const std::vector<Multiple>& multiples) {
  constexpr std::size_t most_columns = 4;
  Box frame;
  for (const Multiple& multiple : multiples) {
    const Box extent = extent_of(*multiple.scene, readings_of(*multiple.scene, multiple.poses));
    frame.include(extent.low);
    frame.include(extent.high);
  }
  std::vector<Canvas> pictures;
  Box bounds;
  for (const Multiple& multiple : multiples) {
    pictures.push_back(drawn(multiple, frame));
    bounds.include(pictures.back().bounds().low);
    bounds.include(pictures.back().bounds().high);
  }
  const double cell = (sheet::width - 2 * sheet::margin - (most_columns - 1) * between_pictures) / most_columns;
  const double scale = std::min(0.6, cell / std::max(1.0, bounds.width()));
  const double height = scale * bounds.height();

  Canvas page;
  double y = sheet::margin / 2;
  for (std::size_t row = 0; row < pictures.size(); row += most_columns) {
    std::size_t lines = 1;
    for (std::size_t i = row; i < std::min(row + most_columns, pictures.size()); ++i) {
      const double x = sheet::margin + static_cast<double>(i - row) * (cell + between_pictures);
      const std::vector<std::string> caption = wrapped(multiples[i].caption, sheet::text_size, cell);
      const Colour colour = multiples[i].colour == Colour::none ? ink::dark : multiples[i].colour;
      for (std::size_t k = 0; k < caption.size(); ++k) {
        page.text({x + cell / 2, y + static_cast<double>(k + 1) * row_of_text}, caption[k],
                  {.size = sheet::text_size, .colour = colour, .halo = false});
      }
      lines = std::max(lines, caption.size());
    }
    y += static_cast<double>(lines) * row_of_text + 10;
    for (std::size_t i = row; i < std::min(row + most_columns, pictures.size()); ++i) {
      const double x = sheet::margin + static_cast<double>(i - row) * (cell + between_pictures);
      const Vec2 middle{x + cell / 2, y + height / 2};
      page.insert(pictures[i], "multiple" + std::to_string(i + 1), middle - scale * bounds.middle(), scale);
    }
    y += height + between_pictures;
  }
  return svg_document(page, sheet::width, y + sheet::margin / 2, "positions", "");
}

}  // namespace poise::app
