#include "formats/sdf/document.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "base/text.h"
#include "files/resources.h"
#include "files/text.h"
#include "formats/sdf/urdf.h"

namespace sandlot::formats {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_depth = 16;

class Loader {
 public:
  Loader(Notes& notes, const SdfOptions& options) : notes_(notes), options_(options) {}

  Result<Xml> load(std::string_view text, const std::string& file) {
    SL_ASSIGN(Xml root, parse_xml(text, file, options_.limits));
    if (root.name == "robot") return urdf_to_sdf(root, notes_);
    SL_ASSIGN(const int minor, version_of(root, notes_));
    modernise(root, minor);
    open_.push_back(canonical_path(file));
    const Status expanded = expand(root, folder_of(file));
    open_.pop_back();
    if (!expanded) return expanded.error();
    return root;
  }

 private:
  /// Replaces the includes in worlds and models, depth first.
  Status expand(Xml& element, const std::string& folder) {
    std::vector<Xml> children;
    children.reserve(element.children.size());
    for (Xml& child : element.children) {
      if (child.name == "include") {
        SL_ASSIGN(std::vector<Xml> included, include(child, element, folder));
        for (Xml& each : included) children.push_back(std::move(each));
        continue;
      }
      const std::size_t before = left_out_;
      if (child.name == "world" || child.name == "model") SL_TRY(expand(child, folder));
      // What held nothing but a missing model is missing as a whole.
      const bool hollow = left_out_ > before && !child.child("link") && !child.child("model");
      if (child.name == "model" && hollow) continue;
      if (child.name == "actor") stand_in_for_actor(child);
      children.push_back(std::move(child));
    }
    element.children = std::move(children);
    return {};
  }

  /// What takes the place of an <include> in `parent`.
  Result<std::vector<Xml>> include(const Xml& include, const Xml& parent, const std::string& folder) {
    const Xml* const uri = include.child("uri");
    if (!uri || uri->text.empty())
      return include.error("<include> has no <uri>", "name a model file or folder");
    notes_.unused(include, "uri name pose static placement_frame plugin*");
    auto path = find(*uri, folder);
    if (!path && options_.skip_missing) {
      notes_.warn(*uri, path.error().what, "it is left out");
      ++left_out_;
      return std::vector<Xml>{};
    }
    if (!path) return std::move(path).error();
    SL_ASSIGN(Xml content, content_of(include, *uri, *path));
    const std::string* const merge = include.attribute("merge");
    const bool merging = merge && *merge != "false" && *merge != "0";
    if (content.name == "world") return world(include, std::move(content), parent);
    if (content.name != "model" && parent.name != "world")
      return uri->error("'" + uri->text.substr(0, 160) + "' holds a <" + content.name + ">",
                        "a <model> can include models only");
    if (const Xml* name = include.child("name")) content.set_attribute("name", name->text);
    if (const Xml* frame = include.child("placement_frame")) {
      if (!include.child("pose"))
        return frame->error("an <include> with a <placement_frame> needs a <pose>",
                            "say where that frame is");
      content.set_attribute("placement_frame", frame->text);
    }
    for (const char* const key : {"pose", "static"}) {
      const Xml* const given = include.child(key);
      if (!given || (content.name == "light" && *key == 's')) continue;
      std::erase_if(content.children, [&](const Xml& child) { return child.name == key; });
      content.children.push_back(*given);
    }
    for (const Xml& child : include.children)
      if (child.name == "plugin") content.children.push_back(child);
    // Complaints about the instance (its name, its pose) belong to the line that asks for it.
    content.place = include.place;
    if (!merging) return std::vector<Xml>{std::move(content)};
    if (content.name != "model" || parent.name != "model")
      return include.error("merge=\"true\" works for a model in a <model> only", "include it without merge");
    return merged(include, content);
  }

  /// The <model>, <light> or <world> of the file; each file is read once.
  Result<Xml> content_of(const Xml& include, const Xml& uri, const std::string& path) {
    const std::string canonical = canonical_path(path);
    if (std::find(open_.begin(), open_.end(), canonical) != open_.end())
      return uri.error("'" + uri.text.substr(0, 160) + "' includes itself", "");
    if (open_.size() >= max_depth) return uri.error("files are included more than 16 deep");
    auto cached = files_.find(canonical);
    if (cached == files_.end()) {
      auto text = read_text_file(path, options_.limits.max_bytes);
      if (!text) return uri.error("cannot include '" + path + "': " + text.error().what, text.error().fix);
      SL_ASSIGN(Xml root, load(*text, path));
      SL_ASSIGN(Xml content, only_content(root));
      const std::size_t size = count_elements(content);
      cached = files_.emplace(canonical, std::pair(std::move(content), size)).first;
    }
    elements_ += cached->second.second;
    if (elements_ > options_.limits.max_elements)
      return include.error("the included files have too many elements together",
                           "at most " + std::to_string(options_.limits.max_elements) + " are read");
    return cached->second.first;
  }

  Result<Xml> only_content(const Xml& root) {
    const Xml* content = nullptr;
    for (const Xml& child : root.children) {
      const bool thing = child.name == "model" || child.name == "light" || child.name == "world";
      if (!thing) continue;
      if (content)
        return child.error("an included file must hold one " + content->name + ", this is its second thing");
      content = &child;
    }
    if (!content) return root.error("an included file must hold a <model>");
    return *content;
  }

  /// What stands in an included world stands in the one that includes it; its sky, physics and plugins do not.
  Result<std::vector<Xml>> world(const Xml& include, Xml content, const Xml& parent) {
    if (parent.name != "world")
      return include.error("a <model> cannot include a world", "include it in a <world>");
    for (const char* const key : {"pose", "name", "static", "placement_frame"})
      if (const Xml* const given = include.child(key))
        return given->error("an included world has no <" + std::string(key) + ">",
                            "what is in it keeps its place and name");
    std::vector<Xml> out;
    for (Xml& child : content.children) {
      const bool thing = child.name == "model" || child.name == "light" || child.name == "frame" ||
                         child.name == "joint";
      if (thing) out.push_back(std::move(child));
    }
    return out;
  }

  Result<std::string> find(const Xml& uri, const std::string& folder) {
    SL_ASSIGN(const std::string path, find_resource(uri.text, folder, options_.path, uri.place));
    std::error_code failed;
    return fs::is_directory(path, failed) ? file_in(uri, path) : Result<std::string>(path);
  }

  /// The model file of a model folder: the newest one of its model.config that we read, or model.sdf.
  Result<std::string> file_in(const Xml& uri, const std::string& folder) {
    const std::string config = folder + "/model.config";
    std::error_code failed;
    if (!fs::exists(config, failed)) return folder + "/model.sdf";
    SL_ASSIGN(const std::string text, read_text_file(config, 1u << 20));
    SL_ASSIGN(const Xml root, parse_xml(text, config, options_.limits));
    double best = -1;
    std::string file;
    for (const Xml& child : root.children) {
      if (child.name != "sdf" || child.text.empty()) continue;
      const std::string* const version = child.attribute("version");
      double number = 0;
      // "1.10" is newer than "1.9": the minor number decides.
      if (version && starts_with(*version, "1.") && !parse_number(version->substr(2), number)) continue;
      const double rank = number > 9 ? 0.5 : number;
      if (rank > best || file.empty()) {
        best = rank;
        file = child.text;
      }
    }
    if (file.empty()) return uri.error("'" + config + "' names no <sdf> file");
    return beside(folder, file);
  }

  Notes& notes_;
  SdfOptions options_;
  std::vector<std::string> open_;  ///< from the first file to the one being read
  std::map<std::string, std::pair<Xml, std::size_t>> files_;
  std::size_t elements_ = 0;
  std::size_t left_out_ = 0;  ///< includes that cannot be found
};

}  // namespace

Result<Xml> load_document(std::string_view text, const std::string& file, Notes& notes,
                          const SdfOptions& options) {
  return Loader(notes, options).load(text, file);
}

}  // namespace sandlot::formats
