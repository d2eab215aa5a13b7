#include "server/preview.h"

#include "formats/image/visible.h"
#include "formats/image/write.h"
#include "messages/cdr.h"

namespace sandlot::server {

std::vector<std::byte> preview_of(const msg::Image& image) {
  constexpr int side = 480, quality = 80;
  msg::CompressedImage out;
  out.header = image.header;
  out.format = "jpeg";
  if (const auto picture = formats::visible(image)) {
    const formats::Picture small = formats::shrunk(*picture, side);
    const std::string bytes = formats::jpeg_of(formats::Pixels8{small.width, small.height, 3, small.rgb},
                                               quality);
    out.data.assign(bytes.begin(), bytes.end());
  }
  std::vector<std::byte> cdr;
  write_cdr(message_info<msg::CompressedImage>(), &out, cdr);
  return cdr;
}

}  // namespace sandlot::server
