#include "draw/plan.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "base/math.h"
#include "draw/outline.h"

namespace sandlot::draw {
namespace {

constexpr std::size_t max_solids = 8000;
constexpr std::size_t max_path_corners = 60'000;
constexpr std::size_t max_detailed_robots = 100;
constexpr std::size_t max_named_robots = 16;

constexpr Color white{1, 1, 1, 1}, black{0, 0, 0, 1};

/// M. Okabe, K. Ito, Color Universal Design (2008), without its yellow and black; then two of our own.
constexpr std::array<Color, 8> palette{{{0.00f, 0.45f, 0.70f, 1},
                                        {0.84f, 0.37f, 0.00f, 1},
                                        {0.00f, 0.62f, 0.45f, 1},
                                        {0.80f, 0.40f, 0.62f, 1},
                                        {0.45f, 0.33f, 0.66f, 1},
                                        {0.90f, 0.62f, 0.00f, 1},
                                        {0.34f, 0.71f, 0.91f, 1},
                                        {0.47f, 0.39f, 0.24f, 1}}};

Color mix(const Color& a, const Color& b, float share_of_b) {
  const auto blend = [&](float x, float y) { return x + share_of_b * (y - x); };
  return {blend(a.r, b.r), blend(a.g, b.g), blend(a.b, b.b), a.a};
}

std::string hex(const Color& c) {
  const auto byte = [](float x) { return static_cast<int>(std::lround(255 * std::clamp(x, 0.0f, 1.0f))); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(c.r), byte(c.g), byte(c.b));
}

long mm(double m) { return static_cast<long>(std::floor(1000 * m + 0.5)); }

/// An axis-aligned area in the world.
struct Area {
  double x0 = std::numeric_limits<double>::infinity(), y0 = x0, x1 = -x0, y1 = -x0;
  bool empty() const { return x0 > x1; }
  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
  void add(Vec3 point, double radius = 0) {
    x0 = std::min(x0, point.x - radius), x1 = std::max(x1, point.x + radius);
    y0 = std::min(y0, point.y - radius), y1 = std::max(y1, point.y + radius);
  }
  void grow(double by) { x0 -= by, y0 -= by, x1 += by, y1 += by; }
  bool contains(Vec3 p) const { return p.x >= x0 && p.x <= x1 && p.y >= y0 && p.y <= y1; }
};

/// A solid with its outline, ready to be sorted and drawn.
struct Drawn {
  Outline outline;
  Color color;
  bool moves = false;
};

std::vector<Drawn> by_height(const std::vector<Plan::Solid>& solids) {
  std::vector<Drawn> drawn;
  for (const Plan::Solid& solid : solids)
    if (auto outline = outline_from_above(solid.shape, solid.X_WC))
      drawn.push_back({std::move(*outline), solid.color, solid.moves});
  if (drawn.size() > max_solids) {
    std::stable_sort(drawn.begin(), drawn.end(),
                     [](const Drawn& a, const Drawn& b) { return a.outline.radius_m > b.outline.radius_m; });
    drawn.resize(max_solids);
  }
  std::stable_sort(drawn.begin(), drawn.end(),
                   [](const Drawn& a, const Drawn& b) { return a.outline.top_m < b.outline.top_m; });
  return drawn;
}

void add(Area& area, const Outline& outline) {
  if (outline.corners.empty()) area.add(outline.centre_m, outline.radius_m);
  for (const Vec3& corner : outline.corners) area.add(corner);
}

bool covers(const Outline& outline, Vec3 point) {
  const Vec3 off = point - outline.centre_m;
  if (off.x * off.x + off.y * off.y > outline.radius_m * outline.radius_m) return false;
  const std::vector<Vec3>& c = outline.corners;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const Vec3 a = c[i], b = c[(i + 1) % c.size()];
    if ((b.x - a.x) * (point.y - a.y) < (b.y - a.y) * (point.x - a.x)) return false;
  }
  return true;
}

/// Area of the drawing: static solids, robots and paths; other moving solids only when they are near those.
Area visible_area(const std::vector<Drawn>& solids, const std::vector<std::vector<Drawn>>& robots,
                  const Plan& plan) {
  Area area;
  for (const Drawn& solid : solids)
    if (!solid.moves) add(area, solid.outline);
  for (const auto& robot : robots)
    for (const Drawn& solid : robot) add(area, solid.outline);
  for (const Plan::Robot& robot : plan.robots)
    for (const auto& part : robot.path)
      for (const Vec3& point : part) area.add(point);
  const bool anything = !area.empty();
  Area near = area;
  if (anything) near.grow(std::max(6.0, 0.5 * std::max(area.width(), area.height())));
  for (const Drawn& solid : solids)
    if (solid.moves && (!anything || near.contains(solid.outline.centre_m))) add(area, solid.outline);
  if (area.empty()) area.add({});
  area.grow(0.3);
  constexpr double least_m = 3;
  const double dx = std::max(0.0, least_m - area.width()) / 2,
               dy = std::max(0.0, least_m - area.height()) / 2;
  area.x0 -= dx, area.x1 += dx, area.y0 -= dy, area.y1 += dy;
  return area;
}

/// 1, 2 or 5 times a power of ten, so that at most `most` of them fit into `length_m`.
double round_step(double length_m, int most) {
  double step = 1;
  while (length_m / step > most) {
    if (length_m / (2 * step) <= most) return 2 * step;
    if (length_m / (5 * step) <= most) return 5 * step;
    step *= 10;
  }
  return step;
}

/// Writes the file from top to bottom.
class Writer {
 public:
  explicit Writer(const Plan& plan) : plan_(plan), solids_(by_height(plan.solids)) {
    for (const Plan::Robot& robot : plan.robots) robots_.push_back(by_height(robot.solids));
    for (const auto& robot : robots_)
      for (const Drawn& solid : robot) robot_top_m_ = std::max(robot_top_m_, solid.outline.top_m);
    area_ = visible_area(solids_, robots_, plan);
    scale_ = std::min({1000 / area_.width(), 820 / area_.height(), 160.0});
    detailed_ = plan.robots.size() <= max_detailed_robots;
    named_ = plan.robots.size() > 1 && plan.robots.size() <= max_named_robots;
  }

  std::string write() {
    const double width = left_ + area_.width() * scale_ + right_;
    legend(width - left_ - right_);  // first, because the height of the page depends on it
    const std::string legend_text = std::exchange(out_, {});
    const double height = axis_y() + 44 + legend_height_;
    put(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0:.0f}" height="{1:.0f}" viewBox="0 0 {0:.0f} {1:.0f}" )"
        R"(font-family="Inter,'Helvetica Neue',Helvetica,Arial,'Liberation Sans','DejaVu Sans',sans-serif" font-size="12">)",
        width, height);
    put("\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
    put(R"(<text x="{:.0f}" y="30" font-size="19" font-weight="600" fill="#1b2330">{}</text>)", left_,
        xml_text(plan_.title));
    put("\n<text x=\"{:.0f}\" y=\"49\" font-size=\"13\" fill=\"#5d6673\">{}</text>\n", left_,
        xml_text(plan_.subtitle));
    put(R"(<clipPath id="frame"><rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/></clipPath>)",
        left_, top_, area_.width() * scale_, area_.height() * scale_);
    // Inside, one unit is a millimetre and y points up.
    put("\n<g clip-path=\"url(#frame)\"><g transform=\"matrix({0:.6f} 0 0 {1:.6f} {2:.3f} {3:.3f})\" "
        "stroke-linejoin=\"round\">\n",
        scale_ / 1000, -scale_ / 1000, left_ - area_.x0 * scale_, top_ + area_.y1 * scale_);
    floor();
    standing();
    scans();
    paths();
    for (std::size_t i = 0; i < plan_.robots.size(); ++i) robot(i);
    put("</g>\n");
    names();
    put("</g>\n");
    axes();
    out_ += legend_text;
    put("</svg>\n");
    return std::move(out_);
  }

 private:
  template <class... Args>
  void put(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Args>(args)...);
  }
  /// So many pixels, in the millimetres of the drawing.
  long px(double pixels) const { return std::max(1L, mm(pixels / scale_)); }
  double axis_y() const { return top_ + area_.height() * scale_; }
  static const Color& color_of(std::size_t robot) { return palette[robot % palette.size()]; }

  void shape(const Outline& outline, const std::string& style) {
    if (outline.corners.empty()) {
      put("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {}/>\n", mm(outline.centre_m.x), mm(outline.centre_m.y),
          mm(outline.radius_m), style);
    } else {
      put("<path d=\"");
      polyline(outline.corners);
      put("z\" {}/>\n", style);
    }
  }

  /// Relative steps between rounded corners: short, and rounding does not add up.
  void polyline(const std::vector<Vec3>& points) {
    long x = 0, y = 0;
    bool stepped = false;  // after the first `l`, further steps need no letter
    for (std::size_t i = 0; i < points.size(); ++i) {
      const long nx = mm(points[i].x), ny = mm(points[i].y);
      if (i == 0) {
        put("M{} {}", nx, ny);
      } else if (nx != x || ny != y) {
        put("{}{}{}{}", !stepped ? "l" : nx < x ? "" : " ", nx - x, ny < y ? "" : " ", ny - y);
        stepped = true;
      }
      x = nx, y = ny;
    }
  }

  void floor() {
    put("<path d=\"M{} {}h{}v{}h{}z\" fill=\"{}\"/>\n", mm(area_.x0), mm(area_.y0), mm(area_.width()),
        mm(area_.height()), -mm(area_.width()), hex(plan_.ground));
    const double step = round_step(std::max(area_.width(), area_.height()), 30);
    put("<path d=\"");
    for (double x = std::ceil(area_.x0 / step) * step; x <= area_.x1; x += step)
      put("M{} {}v{}", mm(x), mm(area_.y0), mm(area_.height()));
    for (double y = std::ceil(area_.y0 / step) * step; y <= area_.y1; y += step)
      put("M{} {}h{}", mm(area_.x0), mm(y), mm(area_.width()));
    put("\" fill=\"none\" stroke=\"#000\" stroke-opacity=\".07\" stroke-width=\"{}\"/>\n", px(1));
  }

  /// With robots in the picture, what they can drive below must not hide them or what they see: table tops,
  /// but not the mattress on a bed, below which something stands that is as high as a robot.
  bool hangs_over_robots(const Drawn& solid) const {
    if (robot_top_m_ <= 0 || solid.outline.bottom_m < robot_top_m_) return false;
    return std::none_of(solids_.begin(), solids_.end(), [&](const Drawn& below) {
      return below.outline.bottom_m < robot_top_m_ && below.outline.top_m >= robot_top_m_ &&
             covers(below.outline, solid.outline.centre_m);
    });
  }

  void standing() {
    put("<g stroke-width=\"{}\">\n", px(1));
    for (const Drawn& solid : solids_) {
      const bool overhead = hangs_over_robots(solid);
      const bool carpet = solid.outline.top_m < 0.02;  // no more than a colour of the floor
      const float opacity = solid.color.a * (overhead ? 0.45f : 1);
      std::string style = fmt::format("fill=\"{}\" stroke=\"{}\"", hex(solid.color),
                                      hex(mix(solid.color, black, carpet ? 0.12f : 0.38f)));
      if (opacity < 0.999f) style += fmt::format(" opacity=\"{:.2f}\"", opacity);
      if (solid.moves) style += fmt::format(" stroke-width=\"{}\"", px(1.8));
      shape(solid.outline, style);
    }
    put("</g>\n");
  }

  void scans() {
    if (!detailed_) return;
    // Many scans on top of each other would hide the room.
    const double opacity = plan_.robots.size() > 2 ? 0.07 : 0.14;
    for (std::size_t i = 0; i < plan_.robots.size(); ++i)
      for (const Plan::Scan& scan : plan_.robots[i].scans) {
        std::vector<Vec3> fan{scan.origin_m};
        fan.insert(fan.end(), scan.ends_m.begin(), scan.ends_m.end());
        put("<path d=\"");
        polyline(fan);
        put("z\" fill=\"{}\" fill-opacity=\"{:.2f}\"/>\n<path d=\"", hex(color_of(i)), opacity);
        for (std::size_t k = 0; k < scan.ends_m.size(); ++k)
          if (scan.hit[k]) put("M{} {}h0", mm(scan.ends_m[k].x), mm(scan.ends_m[k].y));
        put("\" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\"/>\n",
            hex(mix(color_of(i), black, 0.15f)), px(plan_.robots.size() > 2 ? 2.4 : 3.2));
      }
  }

  void paths() {
    double tolerance_m = 0.004;
    std::vector<std::vector<std::vector<Vec3>>> thinned(plan_.robots.size());
    for (std::size_t corners = max_path_corners + 1; corners > max_path_corners; tolerance_m *= 2) {
      corners = 0;
      for (std::size_t i = 0; i < plan_.robots.size(); ++i) {
        thinned[i].clear();
        for (const auto& part : plan_.robots[i].path) {
          if (part.empty()) continue;
          thinned[i].push_back(simplified(part, tolerance_m));
          corners += thinned[i].back().size();
        }
      }
    }
    const double width = plan_.robots.size() <= 3 ? 2.0 : plan_.robots.size() <= 30 ? 1.4 : 0.8;
    for (std::size_t i = 0; i < plan_.robots.size(); ++i) {
      put("<g fill=\"none\" stroke-width=\"{}\" stroke-linecap=\"round\">", px(width));
      std::size_t total = 0, done = 0;
      for (const auto& part : thinned[i]) total += part.size();
      for (const auto& part : thinned[i]) {
        // A few pieces, the older the paler, that share their end points.
        const std::size_t pieces = detailed_ ? std::clamp<std::size_t>(part.size() / 8, 1, 6) : 1;
        for (std::size_t p = 0; p < pieces; ++p) {
          const std::size_t begin = p * (part.size() - 1) / pieces,
                            end = (p + 1) * (part.size() - 1) / pieces;
          const float age = 1 - static_cast<float>(done + end + 1) / static_cast<float>(total);
          put("\n<path class=\"path\" stroke=\"{}\" d=\"", hex(mix(color_of(i), plan_.ground, 0.62f * age)));
          polyline({part.begin() + static_cast<std::ptrdiff_t>(begin),
                    part.begin() + static_cast<std::ptrdiff_t>(end) + 1});
          put("\"/>");
        }
        done += part.size();
      }
      put("</g>\n");
      if (detailed_ && !thinned[i].empty()) start_mark(thinned[i].front().front(), color_of(i));
    }
  }

  void start_mark(Vec3 at, const Color& color) {
    put("<circle class=\"start\" cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"#fff\" stroke=\"{}\" "
        "stroke-width=\"{}\"/>\n",
        mm(at.x), mm(at.y), px(4), hex(color), px(2));
  }

  void robot(std::size_t i) {
    const std::vector<Drawn>& solids = robots_[i];
    const Vec3 at = plan_.robots[i].X_WB.p;
    double reach = 0;
    for (const Drawn& solid : solids)
      reach = std::max(reach, norm(solid.outline.centre_m - Vec3{at.x, at.y, 0}) + solid.outline.radius_m);
    if (reach == 0) reach = 6 / scale_;
    put("<g class=\"robot\"><title>{}</title>\n", xml_text(plan_.robots[i].name));
    const Color& color = color_of(i);
    if (detailed_) {
      double largest = 0;
      for (const Drawn& solid : solids) largest = std::max(largest, solid.outline.radius_m);
      for (const Drawn& solid : solids) {
        const bool hull = solid.outline.radius_m > 0.99 * largest;
        shape(solid.outline, fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"{}\"",
                                         hex(hull ? mix(color, white, 0.2f) : mix(color, black, 0.25f)),
                                         hex(mix(color, black, 0.45f)), px(hull ? 1.5 : 0.7)));
      }
    }
    if (!detailed_ || solids.empty())
      put("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"/>\n", mm(at.x), mm(at.y), mm(reach), hex(color));
    // Heading: an arrow head on the front half.
    const Vec3 forward = rotate(plan_.robots[i].X_WB.q, {1, 0, 0});
    const Vec3 x = normalised(Vec3{forward.x, forward.y, 0});
    const Vec3 y{-x.y, x.x, 0};
    put("<path class=\"heading\" d=\"");
    polyline({at + 0.95 * reach * x, at + 0.3 * reach * x + 0.5 * reach * y, at + 0.45 * reach * x,
              at + 0.3 * reach * x - 0.5 * reach * y});
    put("z\" fill=\"#fff\"/></g>\n");
  }

  void names() {
    if (!named_) return;
    put("<g font-size=\"11\" font-weight=\"600\" text-anchor=\"middle\" stroke=\"#fff\" "
        "stroke-opacity=\".8\" stroke-width=\"3\" "
        "stroke-linejoin=\"round\" paint-order=\"stroke\">\n");
    for (std::size_t i = 0; i < plan_.robots.size(); ++i) {
      double reach = 0;
      for (const Drawn& solid : robots_[i]) reach = std::max(reach, solid.outline.radius_m);
      const Vec3 at = plan_.robots[i].X_WB.p;
      put("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\">{}</text>\n", left_ + (at.x - area_.x0) * scale_,
          top_ + (area_.y1 - at.y - reach) * scale_ - 5, hex(mix(color_of(i), black, 0.3f)),
          xml_text(plan_.robots[i].name));
    }
    put("</g>\n");
  }

  void axes() {
    put("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
        "stroke=\"#9aa1ab\"/>\n",
        left_, top_, area_.width() * scale_, area_.height() * scale_);
    const double step = round_step(std::max(area_.width(), area_.height()), 30);
    const auto label = [](double v) { return mm(v) == 0 ? std::string("0") : fmt::format("{:g}", v); };
    put("<g fill=\"#5d6673\" font-size=\"11\"><g text-anchor=\"middle\">");
    for (double x = std::ceil(area_.x0 / step) * step; x <= area_.x1; x += step)
      put("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", left_ + (x - area_.x0) * scale_, axis_y() + 15,
          label(x));
    put("<text x=\"{:.1f}\" y=\"{:.1f}\">x [m]</text></g>\n<g text-anchor=\"end\">",
        left_ + area_.width() * scale_ / 2, axis_y() + 31);
    for (double y = std::ceil(area_.y0 / step) * step; y <= area_.y1; y += step)
      put("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", left_ - 6, axis_y() - (y - area_.y0) * scale_ + 4,
          label(y));
    put("</g><text text-anchor=\"middle\" transform=\"translate(15 {:.1f}) rotate(-90)\">y [m]</text></g>\n",
        top_ + area_.height() * scale_ / 2);
  }

  /// Entries below the axis in as many rows as they need. Sets legend_height_.
  void legend(double width) {
    double x = 0, row = 0;
    const double top = axis_y() + 44;
    const auto entry = [&](double swatch, const std::string& text, auto&& draw) {
      const double needed = swatch + 6 + 6.4 * static_cast<double>(text.size()) + 22;
      if (x > 0 && x + needed > width) x = 0, row += 20;
      draw(left_ + x, top + row + 6);
      put("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", left_ + x + swatch + 6, top + row + 10,
          xml_text(text));
      x += needed;
    };
    put("<g fill=\"#3a4350\">\n");
    const double bar_m = round_step(area_.width(), 8);
    entry(bar_m * scale_, fmt::format("{:g} m", bar_m), [&](double at, double y) {
      put("<path d=\"M{:.1f} {:.1f}v6m0 -3h{:.1f}m0 -3v6\" stroke=\"#3a4350\" stroke-width=\"1.5\" "
          "fill=\"none\"/>",
          at, y - 3, bar_m * scale_);
    });
    for (std::size_t i = 0; i < plan_.robots.size() && i < max_named_robots; ++i)
      entry(22, fmt::format("{}, {:.1f} m driven", plan_.robots[i].name, plan_.robots[i].driven_m),
            [&](double at, double y) {
              put("<path d=\"M{:.1f} {:.1f}h22\" stroke=\"{}\" stroke-width=\"3\" stroke-linecap=\"round\"/>",
                  at, y, hex(color_of(i)));
            });
    if (plan_.robots.size() > max_named_robots)
      entry(0, fmt::format("and {} more robots", plan_.robots.size() - max_named_robots),
            [](double, double) {});
    if (detailed_ && !plan_.robots.empty()) {
      const std::string any_robot = plan_.robots.size() == 1 ? hex(color_of(0)) : "#5d6673";
      entry(10, "start", [&](double at, double y) {
        put("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"#fff\" stroke=\"{}\" stroke-width=\"2\"/>",
            at + 5, y, any_robot);
      });
      bool any = false;
      for (const Plan::Robot& robot : plan_.robots) any = any || !robot.scans.empty();
      if (any)
        entry(20, "last scan", [&](double at, double y) {
          put("<path d=\"M{0:.1f} {1:.1f}l18 -5v10z\" fill=\"{2}\" fill-opacity=\".2\"/><path d=\"M{3:.1f} "
              "{1:.1f}m0 -5h0m0 5h0m0 5h0\" "
              "stroke=\"{2}\" stroke-width=\"3\" stroke-linecap=\"round\"/>",
              at, y, any_robot, at + 18);
        });
    }
    put("</g>\n");
    legend_height_ = row + 26;
  }

  static constexpr double left_ = 46, right_ = 18, top_ = 66;
  const Plan& plan_;
  std::vector<Drawn> solids_;
  std::vector<std::vector<Drawn>> robots_;
  Area area_;
  double scale_ = 1;  ///< [px/m]
  double robot_top_m_ = 0;
  double legend_height_ = 0;
  bool detailed_ = true, named_ = false;
  std::string out_;
};

}  // namespace

std::string to_svg(const Plan& plan) { return Writer(plan).write(); }

std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) out += c;
    }
  }
  return out;
}

}  // namespace sandlot::draw
