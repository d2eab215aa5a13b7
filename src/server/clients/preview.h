#pragma once
/// Pictures for viewers: beside each Image topic the server offers TOPIC/compressed, a CompressedImage (JPEG) of at most 480 pixels a
/// side, ten times a second of the wall clock at most, and made only while somebody looks.
///
/// Distances and labels come as colours (assets/image/visible.h). A picture that cannot be shown is an empty message.
#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "messages/sensor_images.h"

namespace sandlot::server {

inline constexpr std::string_view preview_suffix = "/compressed";
inline constexpr std::chrono::milliseconds preview_period{100};

inline std::string preview_name(std::string_view topic) { return std::string(topic) += preview_suffix; }
/// @pre `preview` ends with the suffix
inline std::string_view previewed_name(std::string_view preview) {
  return preview.substr(0, preview.size() - preview_suffix.size());
}

/// The message as CDR.
std::vector<std::byte> preview_of(const msg::Image& image);

}  // namespace sandlot::server
