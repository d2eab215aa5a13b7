#include "app/papers/page.h"

#include <fmt/format.h>

#include "draw/plan.h"

namespace sandlot::app {
namespace {

constexpr const char* style =
    "body{font:16px/1.5 sans-serif;max-width:60rem;margin:2rem auto;padding:0 "
    "1rem;color:#222;background:#fff}"
    "h1{font-size:1.6rem}h2{font-size:1.25rem;margin-top:2.2rem}"
    ".table{overflow-x:auto}table{border-collapse:collapse;font-size:.9rem;margin:1rem 0}"
    "th,td{border-bottom:1px solid #ddd;padding:.3rem .7rem;text-align:left;vertical-align:top}"
    "th{border-bottom:2px solid #888}figure{margin:1.2rem 0}figure svg{max-width:100%;height:auto}"
    "figcaption{font-size:.9rem;color:#555}code{white-space:nowrap}";

/// `text` with `added` behind each `place`.
std::string with_added(std::string_view text, std::string_view place, std::string_view added) {
  std::string out;
  for (std::size_t at; (at = text.find(place)) != std::string_view::npos;) {
    out.append(text.substr(0, at + place.size())).append(added);
    text.remove_prefix(at + place.size());
  }
  return out.append(text);
}

/// Escaped, with what stands between two backticks as code; a backtick without another one stays.
std::string marked_up(std::string_view text) {
  std::string out;
  for (std::size_t begin; (begin = text.find('`')) != std::string_view::npos;) {
    const std::size_t end = text.find('`', begin + 1);
    if (end == std::string_view::npos) break;
    out += draw::xml_text(text.substr(0, begin));
    out += "<code>" + draw::xml_text(text.substr(begin + 1, end - begin - 1)) + "</code>";
    text.remove_prefix(end + 1);
  }
  return out + draw::xml_text(text);
}

}  // namespace

ReportPage::ReportPage(std::string_view title, std::string_view source) : title_(title) {
  body_ = fmt::format("<h1>{}</h1>\n<p>{}</p>\n", draw::xml_text(title), marked_up(source));
}

void ReportPage::heading(std::string_view text) {
  body_ += fmt::format("<h2>{}</h2>\n", draw::xml_text(text));
}

void ReportPage::paragraph(std::string_view text) { body_ += fmt::format("<p>{}</p>\n", marked_up(text)); }

void ReportPage::table(const std::vector<std::string>& names,
                       const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::vector<Cell>> cells;
  for (const auto& row : rows) {
    cells.emplace_back();
    for (const std::string& text : row) cells.back().push_back({text});
  }
  rich_table(names, cells);
}

void ReportPage::rich_table(const std::vector<std::string>& names,
                            const std::vector<std::vector<Cell>>& rows) {
  body_ += "<div class=\"table\"><table>\n<tr>";
  for (const std::string& name : names) body_ += fmt::format("<th>{}</th>", draw::xml_text(name));
  body_ += "</tr>\n";
  for (const auto& row : rows) {
    body_ += "<tr>";
    for (const Cell& cell : row) {
      std::string text = cell.is_command ? draw::xml_text(cell.text) : marked_up(cell.text);
      if (cell.is_command) text = "<code>" + text + "</code>";
      if (!cell.link.empty()) text = fmt::format("<a href=\"{}\">{}</a>", draw::xml_text(cell.link), text);
      body_ += "<td>" + text + "</td>";
    }
    body_ += "</tr>\n";
  }
  body_ += "</table></div>\n";
}

void ReportPage::figure(std::string_view svg, std::string_view caption) {
  // A prolog has no place within HTML.
  if (const std::size_t begin = svg.find("<svg"); begin != std::string_view::npos) svg.remove_prefix(begin);
  const std::string number = fmt::format("f{}-", ++figures_);
  std::string own = with_added(svg, " id=\"", number);
  for (const char* const use : {"url(#", "href=\"#"}) own = with_added(own, use, number);
  body_ += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", own, marked_up(caption));
}

std::string ReportPage::html() const {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>{}</title>\n<style>{}</style></head>\n<body>\n{}</body>\n</"
      "html>\n",
      draw::xml_text(title_), style, body_);
}

}  // namespace sandlot::app
