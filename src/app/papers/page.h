#pragma once
/// Report page: one HTML file with text, tables and SVG figures in it, which needs no network. Words between backticks, in paragraphs,
/// cells and captions, are set as code.
#include <string>
#include <string_view>
#include <vector>

namespace sandlot::app {

class ReportPage {
 public:
  ReportPage(std::string_view title, std::string_view source);
  void heading(std::string_view text);
  void paragraph(std::string_view text);
  /// A cell of a table: plain text.
  struct Cell {
    std::string text;
    std::string link = "";    ///< "": none; relative to the page
    bool is_command = false;  ///< set as what is typed
  };
  void table(const std::vector<std::string>& names, const std::vector<std::vector<std::string>>& rows);
  void rich_table(const std::vector<std::string>& names, const std::vector<std::vector<Cell>>& rows);
  /// An SVG, with a caption. Its ids get a number of their own: all figures share one document.
  void figure(std::string_view svg, std::string_view caption);
  /// The whole file.
  std::string html() const;

 private:
  std::string body_, title_;
  int figures_ = 0;
};

}  // namespace sandlot::app
