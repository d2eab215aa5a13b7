/// Every folder of examples/ stands alone: it works when it is copied elsewhere.
#include <gtest/gtest.h>

#include <regex>

#include "command.h"
#include "programs/sandbox.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;

TEST(Examples, EachFolderStandsAlone) {
  const bool sandboxes = static_cast<bool>(programs::sandbox_version());
  const auto user = programs::program_user();
  // A clone in /root, for instance.
  const bool is_hidden = user && !sandboxes &&
                         !programs::can_read(*user, fs::absolute("robios/include").string());
  int checked = 0;
  for (const auto& folder : fs::directory_iterator("examples")) {
    ASSERT_TRUE(folder.is_directory()) << folder.path() << " belongs to no example";
    const TestFolder scratch;
    fs::copy(folder, scratch.path, fs::copy_options::recursive);
    fs::permissions(scratch.path, fs::perms(0755));  // programs that a run starts are not root
    for (const auto& file : fs::directory_iterator(scratch.path)) {
      if (file.path().extension() != ".yaml") continue;
      if (folder.path().filename() == "soccer_team")
        continue;  // a team is not a scenario: soccer_team_test.py
      if (folder.path().filename() == "estimate_recording")
        continue;  // filters are none either: install_test.cpp
      ++checked;
      std::ifstream in(file.path());
      std::string text, line;
      // The plugin and its controller are built by the tests of the installed package.
      while (std::getline(in, line))
        if (!line.starts_with("plugins:") && line.find("kind: wall") == std::string::npos &&
            line.find("kind: my_clearing") == std::string::npos)
          text += line + "\n";
      // Nor does a client come, be it for a team.
      text = std::regex_replace(text, std::regex(", controller: \\{kind: remote[^}]*\\}\\}\nrobots"),
                                "}\nrobots");
      text = std::regex_replace(text, std::regex("\\{kind: remote[^}]*\\}"), "wander");
      // Without a sandbox no program runs that asks for one.
      if (!sandboxes)
        text = std::regex_replace(text, std::regex("kind: robios,"), "kind: robios, sandbox: off,");
      const std::string yaml = scratch.write(file.path().filename(), text);
      const Printed printed = sandlot("run " + yaml + " --headless --duration 1s");
      if (is_hidden && text.find("kind: robios") != std::string::npos) {
        EXPECT_EQ(printed.exit_code, 2);
        EXPECT_NE(printed.out.find("the user nobody, who cannot read '"), std::string::npos) << printed.out;
        continue;
      }
      EXPECT_EQ(printed.exit_code, 0) << folder.path() << "\n" << printed.out;
    }
  }
  EXPECT_EQ(checked, 11);
}

}  // namespace
}  // namespace sandlot::test
