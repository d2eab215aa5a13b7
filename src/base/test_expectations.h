#pragma once
/// Faulty and suspicious input files of the tests: a file's first lines say which messages it expects.
///
///   # expect: line 7: words      in XML the same in a comment; without `line N: ` only the words are compared
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/text.h"

namespace sandlot::test {

struct Expectation {
  int line = 0;  ///< 0: any
  std::string words;
};

/// Expectations of a file; none when its first line has none.
inline std::vector<Expectation> expectations_in(const std::string& path) {
  std::vector<Expectation> out;
  std::ifstream in(path);
  for (std::string text; std::getline(in, text);) {
    const std::string mark = "expect: ";
    const std::size_t begin = text.find(mark);
    if (begin == std::string::npos) break;
    text = text.substr(begin + mark.size());
    if (const std::size_t end = text.rfind(" -->"); end != std::string::npos) text.resize(end);
    Expectation expected;
    if (starts_with(text, "line ")) {
      expected.line = std::stoi(text.substr(5));
      text = text.substr(text.find(": ") + 2);
    }
    expected.words = text;
    out.push_back(expected);
  }
  return out;
}

/// Paths of the files directly in a folder, sorted.
/// @param extension  ".sdf", or "" for all
inline std::vector<std::string> files_in(const std::filesystem::path& folder,
                                         const std::string& extension = "") {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_regular_file() && (extension.empty() || entry.path().extension() == extension))
      out.push_back(entry.path().string());
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace sandlot::test
