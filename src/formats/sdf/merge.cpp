#include "base/text.h"
#include "formats/sdf/document.h"
#include "formats/sdf/frames.h"

namespace sandlot::formats {
namespace {

/// A model's canonical link as a name in it; "" when it has none.
std::string canonical_link(const Xml& model) {
  if (const std::string* const said = model.attribute("canonical_link"); said && !said->empty()) return *said;
  const Xml* const link = model.child("link");
  if (const std::string* const name = link ? link->attribute("name") : nullptr) return *name;
  for (const Xml& child : model.children) {
    const std::string* const name = child.name == "model" ? child.attribute("name") : nullptr;
    if (!name) continue;
    const std::string inner = canonical_link(child);
    if (!inner.empty()) return *name + "::" + inner;
  }
  return "";
}

std::string pose_text(const Pose& X) {
  std::string text;
  for (const double x : {X.p.x, X.p.y, X.p.z, X.q.x, X.q.y, X.q.z, X.q.w}) text += number_text(x) + " ";
  return text;
}

/// Pose of a model whose <pose> is that of a frame in it, in whatever that pose is relative to.
Result<Pose> placed(const Xml& model) {
  Xml alone = model;
  for (Xml& child : alone.children)
    if (child.name == "pose")
      std::erase_if(child.attributes, [](const auto& attribute) { return attribute.first == "relative_to"; });
  Xml root{"sdf", {}, "", {}, model.place};
  root.children.push_back(std::move(alone));
  SL_TRY(check_names(root));
  SL_ASSIGN(const ResolvedFrames frames, resolve_frames(root));
  return frames.poses.at(&root.children.front());
}

/// In what a model's child says about frames, the model's own frame becomes the proxy.
void redirect(Xml& element, const std::string& proxy) {
  for (auto& [key, value] : element.attributes) {
    const bool frame = key == "relative_to" || key == "attached_to" || key == "expressed_in";
    if (frame && value == "__model__") value = proxy;
  }
  for (Xml& child : element.children) {
    if ((child.name == "parent" || child.name == "child") && element.name == "joint" &&
        child.text == "__model__")
      child.text = proxy;
    // Names in a nested model or in a plugin are that one's own.
    if (child.name != "model" && child.name != "plugin") redirect(child, proxy);
  }
}

/// Gives an element that is placed in the model itself its place in the proxy frame.
void place_in_proxy(Xml& element, const std::string& proxy) {
  Xml* pose = element.child("pose");
  if (!pose) {
    element.children.push_back({"pose", {}, "", {}, element.place});
    pose = &element.children.back();
  }
  const std::string* const relative = pose->attribute("relative_to");
  if (!relative || relative->empty() || *relative == "__model__") pose->set_attribute("relative_to", proxy);
}

}  // namespace

Result<std::vector<Xml>> merged(const Xml& include, const Xml& model) {
  const std::string* const name = model.attribute("name");
  if (!name || name->empty()) return include.error("the included model has no name", "give it a <name>");
  const std::string link = canonical_link(model);
  if (link.empty()) return include.error("the included model has no link to merge");
  const std::string proxy = "_merged__" + *name + "__model__";
  Xml frame{"frame", {{"name", proxy}, {"attached_to", link}}, "", {}, include.place};
  Xml pose{"pose", {}, "", {}, include.place};
  if (const Xml* const own = model.child("pose")) pose = *own;
  if (const std::string* const placement = model.attribute("placement_frame");
      placement && !placement->empty()) {
    SL_ASSIGN(const Pose X, placed(model));
    std::erase_if(pose.attributes, [](const auto& attribute) { return attribute.first != "relative_to"; });
    pose.set_attribute("rotation_format", "quat_xyzw");
    pose.text = pose_text(X);
  }
  if (const std::string* const relative = pose.attribute("relative_to"); !relative || relative->empty())
    pose.set_attribute("relative_to", "__model__");
  frame.children.push_back(std::move(pose));
  std::vector<Xml> out{std::move(frame)};
  for (Xml child : model.children) {
    const bool own = child.name == "pose" || child.name == "static" || child.name == "self_collide" ||
                     child.name == "allow_auto_disable" || child.name == "enable_wind";
    if (own) continue;
    if (child.name == "link" || child.name == "model") place_in_proxy(child, proxy);
    if (child.name == "frame") {
      const std::string* const attached = child.attribute("attached_to");
      if (!attached || attached->empty()) child.set_attribute("attached_to", proxy);
    }
    if (child.name != "model" && child.name != "plugin") redirect(child, proxy);
    out.push_back(std::move(child));
  }
  return out;
}

}  // namespace sandlot::formats
