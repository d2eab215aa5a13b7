#include "app/papers/pictures.h"

#include <fmt/format.h>

#include <algorithm>

#include "assets/image/write.h"
#include "base/base64.h"
#include "draw/plan.h"

namespace sandlot::app {

PictureTile tile_of(const assets::Picture& picture, std::string title) {
  return {std::move(title), picture.width, picture.height, picture.rgb};
}

std::string picture_svg(const std::vector<PictureTile>& tiles, int columns) {
  constexpr int gap = 12;
  const bool titled = std::any_of(tiles.begin(), tiles.end(), [](const auto& t) { return !t.title.empty(); });
  const int line = titled ? 24 : 0;
  const int count = static_cast<int>(tiles.size());
  double width = 0, height = 0;  // of a place
  for (const PictureTile& each : tiles) {
    width = std::max(width, each.scale * each.width);
    height = std::max(height, each.scale * each.height);
  }
  const int rows = (count + columns - 1) / columns;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
      "height=\"{1:g}\" "
      "font-family=\"sans-serif\" font-size=\"15\">",
      columns * width + (columns - 1) * gap, rows * (height + line) + (rows - 1) * gap);
  for (int i = 0; i < count; ++i) {
    const PictureTile& tile = tiles[static_cast<std::size_t>(i)];
    const std::string png = assets::png_of({tile.width, tile.height, 3, tile.rgb});
    const double scale = tile.scale;
    const double x = i % columns * (width + gap), y = i / columns * (height + line + gap);
    if (titled)
      out += fmt::format("<text x=\"{:g}\" y=\"{:g}\">{}</text>", x, y + 17, draw::xml_text(tile.title));
    out += fmt::format(
        "<image x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\" style=\"image-rendering:pixelated\" "
        "href=\"data:image/png;base64,",
        x, y + line, scale * tile.width, scale * tile.height);
    add_base64(std::as_bytes(std::span(png)), out);
    out += "\"/>";
    for (const PictureMark& mark : tile.marks) {
      // A pixel and a half of air; a pixel reaches from its column to the next.
      const double left = x + scale * (mark.left - 1.5), top = y + line + scale * (mark.top - 1.5);
      out += fmt::format(
          "<rect x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\" fill=\"none\" stroke=\"{}\" "
          "stroke-width=\"1.5\"/>",
          left, top, scale * (mark.right - mark.left + 4), scale * (mark.bottom - mark.top + 4), mark.colour);
      if (!mark.text.empty())
        out += fmt::format(
            "<text x=\"{:g}\" y=\"{:g}\" font-size=\"12\" fill=\"{}\" stroke=\"#000\" stroke-width=\"2.5\" "
            "paint-order=\"stroke\">{}</text>",
            left, top - 4, mark.colour, draw::xml_text(mark.text));
    }
  }
  return out + "</svg>\n";
}

}  // namespace sandlot::app
