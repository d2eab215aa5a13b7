#include "server/clients/preview.h"

#include "assets/image/visible.h"
#include "assets/image/write.h"
#include "messages/cdr.h"

namespace sandlot::server {

std::vector<std::byte> preview_of(const msg::Image& image) {
  constexpr int side = 480, quality = 80;
  msg::CompressedImage out;
  out.header = image.header;
  out.format = "jpeg";
  if (const auto picture = assets::visible(image)) {
    const assets::Picture small = assets::shrunk(*picture, side);
    const std::string bytes = assets::jpeg_of(assets::Pixels8{small.width, small.height, 3, small.rgb},
                                              quality);
    out.data.assign(bytes.begin(), bytes.end());
  }
  std::vector<std::byte> cdr;
  write_cdr(message_info<msg::CompressedImage>(), &out, cdr);
  return cdr;
}

}  // namespace sandlot::server
