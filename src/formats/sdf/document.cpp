#include "formats/sdf/document.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "base/text.h"
#include "formats/resources.h"
#include "formats/sdf/urdf.h"
#include "formats/text.h"

namespace sandlot::formats {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_depth = 16;

/// The minor number of version "1.x".
Result<int> version_of(const Xml& root, Notes& notes) {
  if (root.name != "sdf")
    return root.error("the root element is <" + root.name.substr(0, 60) + ">",
                      "an SDF file begins with <sdf version=\"1.9\">, a URDF file with <robot>");
  const std::string* const text = root.attribute("version");
  if (!text) return root.error("<sdf> has no version", "write <sdf version=\"1.9\">");
  const std::vector<std::string_view> parts = split(*text, '.');
  double major = 0, minor = 0;
  const bool numbers = parts.size() == 2 && parts[1].size() <= 2 && parse_number(parts[0], major) &&
                       parse_number(parts[1], minor);
  if (!numbers || major != 1 || minor != std::floor(minor) || minor < 0 || minor > 30)
    return root.error("version '" + text->substr(0, 20) + "' of SDF is not known", "1.5 to 1.9 are read");
  if (minor < 5)
    return root.error("version " + *text + " of SDF is too old",
                      "convert it to 1.5 or newer: gz sdf -p file.sdf");
  if (minor > 9)
    notes.warn(root, "version " + *text + " of SDF is newer than 1.9", "what it added is not understood");
  return static_cast<int>(minor);
}

/// Rewrites what `minor` says differently from 1.9. The changes are those of libsdformat's *.convert files.
void modernise(Xml& element, int minor) {
  if (element.name == "pose" && minor < 7)
    for (auto& [key, value] : element.attributes)
      if (key == "frame") key = "relative_to";
  if (element.name == "axis" && minor < 7) {
    const Xml* const flag = element.child("use_parent_model_frame");
    const bool in_model = flag && (flag->text == "1" || flag->text == "true" || flag->text == "True" ||
                                   flag->text == "TRUE");
    Xml* const xyz = element.child("xyz");
    if (in_model && xyz) xyz->set_attribute("expressed_in", "__model__");
    std::erase_if(element.children, [](const Xml& child) { return child.name == "use_parent_model_frame"; });
  }
  if (element.name == "world" && minor < 6 && !element.child("gravity")) {
    const Xml* const physics = element.child("physics");
    const Xml* const gravity = physics ? physics->child("gravity") : nullptr;
    if (gravity) element.children.push_back(Xml(*gravity));
  }
  for (Xml& child : element.children) modernise(child, minor);
}

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
    for (Xml& child : element.children) {
      if (child.name == "include") {
        SL_ASSIGN(Xml model, include(child, folder));
        child = std::move(model);
      } else if (child.name == "world" || child.name == "model") {
        SL_TRY(expand(child, folder));
      }
    }
    return {};
  }

  Result<Xml> include(const Xml& include, const std::string& folder) {
    const Xml* const uri = include.child("uri");
    if (!uri || uri->text.empty())
      return include.error("<include> has no <uri>", "name a model file or folder");
    if (const std::string* merge = include.attribute("merge"); merge && *merge != "false" && *merge != "0")
      return include.error("merge=\"true\" is not supported yet", "include the model without it");
    notes_.unused(include, "uri name pose static placement_frame plugin*");
    SL_ASSIGN(const std::string path, find(*uri, folder));
    const std::string canonical = canonical_path(path);
    if (std::find(open_.begin(), open_.end(), canonical) != open_.end())
      return uri->error("'" + uri->text + "' includes itself", "");
    if (open_.size() >= max_depth) return uri->error("files are included more than 16 deep");
    auto cached = files_.find(canonical);
    if (cached == files_.end()) {
      auto text = read_text_file(path, options_.limits.max_bytes);
      if (!text) return uri->error("cannot include '" + path + "': " + text.error().what, text.error().fix);
      SL_ASSIGN(Xml root, load(*text, path));
      SL_ASSIGN(Xml model, only_model(root));
      const std::size_t size = count_elements(model);
      cached = files_.emplace(canonical, std::pair(std::move(model), size)).first;
    }
    elements_ += cached->second.second;
    if (elements_ > options_.limits.max_elements)
      return include.error("the included files have too many elements together",
                           "at most " + std::to_string(options_.limits.max_elements) + " are read");
    Xml model = cached->second.first;
    if (const Xml* name = include.child("name")) model.set_attribute("name", name->text);
    if (const Xml* frame = include.child("placement_frame"))
      model.set_attribute("placement_frame", frame->text);
    for (const char* const key : {"pose", "static"}) {
      const Xml* const given = include.child(key);
      if (!given) continue;
      std::erase_if(model.children, [&](const Xml& child) { return child.name == key; });
      model.children.push_back(*given);
    }
    for (const Xml& child : include.children)
      if (child.name == "plugin") model.children.push_back(child);
    // Complaints about the instance (its name, its pose) belong to the line that asks for it.
    model.place = include.place;
    return model;
  }

  Result<Xml> only_model(const Xml& root) {
    const Xml* model = nullptr;
    for (const Xml& child : root.children) {
      if (child.name != "model") continue;
      if (model) return child.error("an included file must hold one model, this is its second one");
      model = &child;
    }
    if (!model) return root.error("an included file must hold a <model>");
    return *model;
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
};

}  // namespace

Result<Xml> load_document(std::string_view text, const std::string& file, Notes& notes,
                          const SdfOptions& options) {
  return Loader(notes, options).load(text, file);
}

}  // namespace sandlot::formats
