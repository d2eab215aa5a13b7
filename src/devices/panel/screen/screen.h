#pragma once
/// Screen: the colour LCD of a robot, drawn by its program and looked at by people.
///
/// Frame    pixel (0, 0) is the upper left one.
/// Command  level `pixels`: sandlot_msgs/ScreenPatch, up to 64 in a tick, drawn in their order: new pixels of a rectangle, or the
///          lines of text and the labels of the keys, or both. A patch that reaches outside of the screen, or whose data are
///          not width x height x 3 bytes, is refused as a whole and counted.
/// Output   level `pixels`: sensor_msgs/Image rgb8 on `pixels`, and sandlot_msgs/ScreenText on `text`; each when it has changed, at
///          most `rate` times per second, and again every `repeat` for those who came later. There is no image until something is
///          drawn: the screen has its background.
/// Service  clear (std_srvs/Trigger): a screen of the background without text.
/// Time     a patch is drawn in its tick.
/// Limits   the picture and the text are independent: who draws letters sends both. At most 200 lines and 16 labels, 400 bytes
///          each; longer ones are cut. No backlight, no viewing angle. Cameras do not see it.
/// Cost     nothing until something is drawn; then width x height x 3 bytes twice, copied when a changed picture is published.
///          The state is hashed in ticks with a change or a sample. Allocates when first drawn.
/// Errors   none beyond the ranges of the keys.
#include <array>

#include "base/time.h"
#include "devices/kind.h"
#include "messages/device_services.h"
#include "messages/messages.h"
#include "messages/sensor_images.h"

namespace sandlot::screen {

struct Spec {
  int width_px = 320, height_px = 240;
  double rate_hz = 10;
  double repeat_s = 1;
  std::array<double, 3> background{0, 0, 0};

  static void fields(auto& s, auto&& visit) {
    visit(Field{"width", "px", "Number of columns.", 16, 1024}, s.width_px);
    visit(Field{"height", "px", "Number of rows.", 16, 1024}, s.height_px);
    visit(Field{"rate", "Hz", "Most messages per second; 0: one in every tick with a change.", 0, 1e5},
          s.rate_hz);
    visit(Field{"repeat", "s",
                "Time after which an unchanged picture is published again, for viewers that came later; 0: "
                "never.",
                0, 1e6},
          s.repeat_s);
    visit(Field{"background", "", "Colour of the empty screen: red, green and blue, each 0 to 1.", 0, 1},
          s.background);
  }
};

struct State {
  std::vector<std::uint8_t> pixels;       ///< empty until something is drawn, and when the screen is cleared
  std::vector<std::string> lines, menu;   ///< text
  std::uint64_t taken = 0, refused = 0;   ///< patches
  std::uint64_t drawn = 0, written = 0;   ///< changes of the pixels, of the text
  std::uint64_t pictures = 0, texts = 0;  ///< the change published last, of each
  Time picture_at, text_at;               ///< when

  static void fields(auto& s, auto&& visit) {
    visit(Field{"pixels", "", "Pixels: red, green, blue, row by row; none while the screen is empty."},
          s.pixels);
    visit(Field{"lines", "", "Lines of text."}, s.lines);
    visit(Field{"menu", "", "Labels of the keys."}, s.menu);
    visit(Field{"taken", "1", "Number of patches so far."}, s.taken);
    visit(Field{"refused", "1", "Number of patches that were not drawn."}, s.refused);
    visit(Field{"drawn", "1", "Number of changes of the picture."}, s.drawn);
    visit(Field{"written", "1", "Number of changes of the text."}, s.written);
    visit(Field{"pictures", "1", "Change of the picture that was published last."}, s.pictures);
    visit(Field{"texts", "1", "Change of the text that was published last."}, s.texts);
    visit(Field{"picture_at", "s", "Time of the latest image."}, s.picture_at);
    visit(Field{"text_at", "s", "Time of the latest text."}, s.text_at);
  }
};

struct Screen {
  using Spec = screen::Spec;
  using State = screen::State;
  Spec spec;
  State state;
  CommandQueue<msg::ScreenPatch>* patches = nullptr;
  Topic<msg::Image>* image = nullptr;
  Topic<msg::ScreenText>* text = nullptr;

  static Result<Screen> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<Screen> pool, const Context& context);
  static void sense(PoolView<Screen> pool, const Context& context);
  bool fits() const;
  std::uint64_t changes() const { return state.taken; }  // `clear` is a request, which is hashed anyway
  void draw(const msg::ScreenPatch& patch);
  Result<msg::std_srvs::Trigger::Response> clear(const msg::std_srvs::Trigger::Request&, const Context&);

 private:
  std::size_t bytes() const {
    return static_cast<std::size_t>(spec.width_px) * static_cast<std::size_t>(spec.height_px) * 3;
  }
  void fill(std::vector<std::uint8_t>& pixels) const;
  void publish_picture(Time now);
};

extern const Kind kind;

}  // namespace sandlot::screen
