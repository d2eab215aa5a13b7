/// The page inside the program, whichever it is: the built one, or the one that says how to build it.
#include <gtest/gtest.h>

#include <set>

#include "server/server.h"

namespace sandlot::server {
namespace {

std::string text_of(const PageFile& file) {
  return {reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size()};
}

TEST(Page, StartsWithAnHtmlDocumentThatIsWhole) {
  const PageFile* index = nullptr;
  for (const PageFile& file : page_files())
    if (file.path == "/") index = &file;
  ASSERT_TRUE(index);
  EXPECT_EQ(index->type, "text/html; charset=utf-8");
  const std::string text = text_of(*index);
  EXPECT_EQ(text.rfind("<!doctype html>", 0), 0u) << text.substr(0, 40);
  // The last bytes of the file are there, and nothing behind them.
  EXPECT_NE(text.find("</html>"), std::string::npos);
  EXPECT_EQ(text.find('\0'), std::string::npos);
}

TEST(Page, EachFileHasItsOwnPathATypeAndATagThatNamesItsContent) {
  std::set<std::string_view> paths, tags;
  for (const PageFile& file : page_files()) {
    EXPECT_TRUE(paths.insert(file.path).second) << file.path;
    EXPECT_EQ(file.path.front(), '/');
    EXPECT_FALSE(file.type.empty());
    EXPECT_FALSE(file.bytes.empty()) << file.path;
    // Files differ, so do these.
    EXPECT_EQ(file.etag.size(), 16u);
    EXPECT_EQ(file.etag.find_first_not_of("0123456789abcdef"), file.etag.npos);
    EXPECT_TRUE(tags.insert(file.etag).second) << file.path;
  }
}

TEST(Page, WhatTheDocumentNamesIsThere) {
  std::set<std::string_view> paths;
  std::string index;
  for (const PageFile& file : page_files()) {
    paths.insert(file.path);
    if (file.path == "/") index = text_of(file);
  }
  EXPECT_EQ(has_page(), paths.contains("/main.js"));
  std::size_t named = 0;
  for (const char* const attribute : {"src=\"", "href=\""})
    for (std::size_t at = index.find(attribute); at != std::string::npos;
         at = index.find(attribute, at + 1)) {
      const std::size_t begin = at + std::string_view(attribute).size();
      std::string path = index.substr(begin, index.find('"', begin) - begin);
      if (path.rfind("data:", 0) == 0 || path.rfind('#', 0) == 0) continue;
      if (path.rfind("./", 0) == 0) path = path.substr(1);
      if (path.front() != '/') path = "/" + path;
      EXPECT_TRUE(paths.contains(path)) << path;
      ++named;
    }
  EXPECT_EQ(named > 0, has_page()) << "the built page has a script at least";
}

}  // namespace
}  // namespace sandlot::server
