#include "files/text.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include "base/text.h"

namespace sandlot {
namespace {

namespace fs = std::filesystem;

/// Length of the UTF-8 sequence at `s`, 0 when it is none (overlong forms and surrogates included).
std::size_t utf8_length(std::string_view s) {
  const auto byte = [&](std::size_t i) { return i < s.size() ? static_cast<unsigned char>(s[i]) : 0u; };
  const auto tail = [&](std::size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return tail(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    const bool overlong = first == 0xE0 && byte(1) < 0xA0;
    const bool surrogate = first == 0xED && byte(1) > 0x9F;
    return tail(1) && tail(2) && !overlong && !surrogate ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const bool overlong = first == 0xF0 && byte(1) < 0x90;
    const bool beyond = first == 0xF4 && byte(1) > 0x8F;
    return tail(1) && tail(2) && tail(3) && !overlong && !beyond ? 4 : 0;
  }
  return 0;
}

}  // namespace

Result<std::string> read_text_file(const std::string& path, std::size_t max_bytes) {
  const auto refuse = [&](std::string what, std::string fix = "") {
    return Error{std::move(what), std::move(fix), place_in(path)};
  };
  if (path.empty() || path.find('\0') != std::string::npos)
    return Error{"the file name is empty or has a NUL in it"};
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (status.type() == fs::file_type::not_found) return refuse("no such file", nearest_file(path));
  if (failed) return refuse("cannot be opened: " + failed.message());
  if (fs::is_directory(status)) return refuse("is a folder", "name a file in it");
  if (!fs::is_regular_file(status)) return refuse("is not a regular file");
  const std::uintmax_t size = fs::file_size(path, failed);
  if (failed) return refuse("cannot be opened: " + failed.message());
  const std::string limit = "at most " + std::to_string(max_bytes >> 20) + " MiB are read";
  if (size > max_bytes) return refuse("is too large: " + std::to_string(size >> 20) + " MiB", limit);
  std::ifstream in(path, std::ios::binary);
  if (!in) return refuse("cannot be read", "is it readable for you?");
  std::string text(static_cast<std::size_t>(size), '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad() || static_cast<std::size_t>(in.gcount()) != text.size())
    return refuse("changed while it was read");
  return text;
}

std::string nearest_file(const std::string& path) {
  constexpr std::size_t most = 10'000;  // entries of a folder that are compared
  const fs::path wanted(path), folder = wanted.parent_path();
  std::error_code failed;
  if (!folder.empty() && !fs::is_directory(folder, failed))
    return "there is no folder '" + folder.string() + "'";
  std::vector<std::string> names;
  fs::directory_iterator entry(folder.empty() ? "." : folder, failed);
  for (; !failed && entry != fs::directory_iterator() && names.size() < most; entry.increment(failed))
    names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());  // of equally near names the same one on every machine
  const std::string near = nearest(wanted.filename().string(), names);
  return near.empty() ? "" : "did you mean '" + (folder / near).string() + "'?";
}

Status check_text(std::string_view text, const std::string& file) {
  int line = 1;
  std::size_t line_begin = 0;
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == '\n') {
      ++line;
      line_begin = ++i;
      continue;
    }
    const bool control = (c < 0x20 && c != '\t' && c != '\r') || c == 0x7F;
    const std::size_t length = control ? 0 : utf8_length(text.substr(i, 4));
    if (length == 0) {
      constexpr char digits[] = "0123456789abcdef";
      const std::string byte = {'0', 'x', digits[c >> 4], digits[c & 15]};
      return Error{control ? "control character " + byte : "byte " + byte + " is not valid UTF-8",
                   "is this a text file?", place_in(file, line, static_cast<int>(i - line_begin) + 1)};
    }
    i += length;
  }
  return {};
}

std::string folder_of(std::string_view path) { return fs::path(path).parent_path().string(); }

std::string beside(const std::string& folder, const std::string& path) {
  const fs::path joined = folder.empty() ? fs::path(path) : fs::path(folder) / path;
  return joined.lexically_normal().string();
}

std::string canonical_path(const std::string& path) {
  std::error_code failed;
  const fs::path canonical = fs::weakly_canonical(path, failed);
  return failed ? path : canonical.string();
}

}  // namespace sandlot
