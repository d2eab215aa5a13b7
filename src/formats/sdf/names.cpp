#include <map>

#include "base/text.h"
#include "formats/sdf/frames.h"

namespace sandlot::formats {
namespace {

Result<std::string> own_name(const Xml& element) {
  const std::string* const name = element.attribute("name");
  if (!name || trim(*name).empty())
    return element.error("<" + element.name + "> has no name", "write <" + element.name + " name=\"...\">");
  if (name->size() > 200) return element.error("the name of this <" + element.name + "> is too long");
  const bool reserved = *name == "world" || (name->size() >= 4 && starts_with(*name, "__") &&
                                             name->substr(name->size() - 2) == "__");
  if (reserved) return element.error("the name '" + *name + "' is reserved by SDF", "take another one");
  return *name;
}

constexpr std::size_t max_reference = 8000;  ///< thirty names of 200 characters with what joins them

/// What a world or model can refer to: its links, joints, frames, models by name.
class Scope {
 public:
  static Result<Scope> create(const Xml& element) {
    Scope scope;
    for (const Xml& child : element.children) {
      if (!is_one_of(child.name, {"link", "joint", "frame", "model"})) continue;
      SL_ASSIGN(std::string name, own_name(child));
      const auto [known, fresh] = scope.members_.emplace(std::move(name), Member{&child});
      if (fresh) continue;
      const std::string& other = known->second.element->name;
      // A link and a joint of one name are common: where a frame is named, the link is meant.
      if (other == "joint" && child.name == "link") known->second.element = &child;
      else if (!(other == "link" && child.name == "joint"))
        return child.error("the name '" + known->first + "' is given twice in " + said(element),
                           "the other one is the <" + known->second.element->name + "> in " +
                               where(*known->second.element, child));
    }
    return scope;
  }
  static std::string said(const Xml& element) {
    const std::string* const name = element.attribute("name");
    return "this " + element.name + (name ? " ('" + *name + "')" : "");
  }
  static std::string where(const Xml& element, const Xml& from) {
    return element.place.file && from.place.file && *element.place.file == *from.place.file
               ? "line " + std::to_string(element.place.line)
               : to_string(element.place);
  }
  struct Member {
    const Xml* element;
    int state = 0;  ///< of the search for circles: 0 new, 1 on the way, 2 done
  };
  std::map<std::string, Member>& members() { return members_; }
  /// The member that a name is or leads through; null for the scope's own frame.
  Member* member(const std::string& name) {
    for (std::size_t end = name.size(); end != std::string::npos && end > 0; end = name.rfind("::", end - 1))
      if (const auto found = members_.find(name.substr(0, end)); found != members_.end())
        return &found->second;
    return nullptr;
  }
  const Xml* find(const std::string& name) const {
    const auto found = members_.find(name);
    return found == members_.end() ? nullptr : found->second.element;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& [name, member] : members_) out.push_back(name);
    return out;
  }

 private:
  std::map<std::string, Member> members_;
};

/// Names among children of one sort, such as the collisions of a link.
Status check_unique(const Xml& parent, const char* sort) {
  std::map<std::string, const Xml*> seen;
  for (const Xml& child : parent.children) {
    if (child.name != sort) continue;
    SL_ASSIGN(std::string name, own_name(child));
    const auto [known, fresh] = seen.emplace(std::move(name), &child);
    if (!fresh)
      return child.error("the name '" + known->first + "' is given to two " + sort + "s",
                         "the other one is in " + Scope::where(*known->second, child));
  }
  return {};
}

class Checker {
 public:
  Status check(const Xml& element, int depth) {
    SL_ASSIGN(Scope* const found, scope_of(element));
    Scope& scope = *found;
    const bool world = element.name == "world";
    for (const Xml& child : element.children) {
      if (is_one_of(child.name, {"link", "joint", "frame", "model", "light"}))
        if (const Xml* pose = child.child("pose"))
          SL_TRY(check_reference(*pose, "relative_to", element, scope));
      if (child.name == "link") SL_TRY(check_link(child, element, scope));
      if (child.name == "joint") SL_TRY(check_joint(child, element, scope));
      if (child.name == "frame") SL_TRY(check_reference(child, "attached_to", element, scope));
      if (child.name == "model") {
        if (depth > 30) return child.error("models are nested too deeply");
        SL_TRY(check(child, depth + 1));
        SL_TRY(check_inner(child, "placement_frame"));
        SL_TRY(check_inner(child, "canonical_link"));
      }
    }
    if (world) SL_TRY(check_unique(element, "light"));
    return check_circles(scope);
  }
  /// A model's attribute that names something inside it.
  Status check_inner(const Xml& model, const char* key) {
    SL_ASSIGN(const Scope* const scope, scope_of(model));
    SL_TRY(check_reference(model, key, model, *scope));
    const std::string* const name = model.attribute(key);
    const bool link_needed = name && !name->empty() && std::string_view(key) == "canonical_link";
    if (link_needed && !is_link(model, *name))
      return model.error("canonical_link '" + name->substr(0, 60) + "' is not a link");
    return {};
  }

 private:
  /// A model's names are looked up many times, and it may hold many.
  Result<Scope*> scope_of(const Xml& element) {
    const auto known = scopes_.find(&element);
    if (known != scopes_.end()) return &known->second;
    SL_ASSIGN(Scope scope, Scope::create(element));
    return &scopes_.emplace(&element, std::move(scope)).first->second;
  }

  /// What `a::b::c` means in a scope: a member, or what is called `c` in the model `a::b`, or `b::c` in the model `a`:
  /// files that flattened their nested models have names with '::'. Null when there is no such thing; the element itself
  /// for its own frame. Each nested model is entered once at most, as the name is used up on the way to it.
  const Xml* find(const Xml& element, const std::string& name) {
    if (name.size() > max_reference) return nullptr;
    if (name == (element.name == "world" ? "world" : "__model__")) return &element;
    const auto scope = scope_of(element);
    if (!scope) return nullptr;
    if (const Xml* const found = (*scope)->find(name)) return found;
    for (std::size_t at = name.rfind("::"); at != std::string::npos && at > 0;
         at = name.rfind("::", at - 1)) {
      const Xml* const outer = (*scope)->find(name.substr(0, at));
      if (!outer || outer->name != "model") continue;
      if (const Xml* const found = find(*outer, name.substr(at + 2))) return found;
    }
    return nullptr;
  }
  bool is_link(const Xml& model, const std::string& name) {
    const Xml* const found = find(model, name);
    return found && found->name == "link";
  }

  Status check_reference(const Xml& holder, const char* key, const Xml& element, const Scope& scope) {
    const std::string* const name = holder.attribute(key);
    if (!name || name->empty() || *name == "__root__" || find(element, *name)) return {};
    return holder.error("no frame '" + name->substr(0, 60) + "' in " + Scope::said(element),
                        suggestion(*name, scope.names()));
  }

  Status check_link(const Xml& link, const Xml& model, const Scope& scope) {
    for (const char* const sort : {"collision", "visual", "sensor", "light"}) {
      SL_TRY(check_unique(link, sort));
      for (const Xml& child : link.children)
        if (child.name == sort)
          if (const Xml* pose = child.child("pose"))
            SL_TRY(check_reference(*pose, "relative_to", model, scope));
    }
    if (const Xml* inertial = link.child("inertial"))
      if (const Xml* pose = inertial->child("pose"))
        if (const std::string* relative = pose->attribute("relative_to"); relative && !relative->empty())
          return pose->error("the pose of an <inertial> is relative to its link", "leave relative_to out");
    return {};
  }

  Status check_joint(const Xml& joint, const Xml& model, const Scope& scope) {
    for (const char* const end : {"parent", "child"}) {
      const Xml* const element = joint.child(end);
      if (!element || element->text.empty())
        return joint.error("joint '" + *joint.attribute("name") + "' has no <" + end + ">", "name a link");
      const std::string& name = element->text;
      const bool parent = end[0] == 'p';
      if (name == "world") {
        if (parent) continue;
        return element->error("the world cannot be the child of a joint", "make it the parent");
      }
      if (const Xml* const target = find(model, name)) {
        if (target == &joint) return element->error("the joint '" + name + "' is its own " + end);
        continue;
      }
      std::vector<std::string> links;
      for (const Xml& child : model.children)
        if (child.name == "link") links.push_back(*child.attribute("name"));
      return element->error("joint '" + *joint.attribute("name") + "': no link '" + name.substr(0, 60) +
                                "' in " + Scope::said(model),
                            suggestion(name, links));
    }
    for (const char* const key : {"axis", "axis2"})
      if (const Xml* axis = joint.child(key))
        if (const Xml* xyz = axis->child("xyz")) SL_TRY(check_reference(*xyz, "expressed_in", model, scope));
    SL_TRY(check_unique(joint, "sensor"));
    return {};
  }

  /// What the pose of a member, or what it is fixed to, starts from: a name in its scope or "".
  static std::string origin_of(const Xml& element, bool attachment) {
    const auto attribute = [](const Xml* holder, const char* key) -> std::string {
      const std::string* const value = holder ? holder->attribute(key) : nullptr;
      return value ? *value : "";
    };
    if (attachment)
      return element.name == "frame"                             ? attribute(&element, "attached_to")
             : element.name == "joint" && element.child("child") ? element.child("child")->text
                                                                 : "";
    std::string relative = attribute(element.child("pose"), "relative_to");
    if (relative.empty()) relative = origin_of(element, true);
    return relative;
  }

  /// Each member has one origin at most, so a circle is found by walking until something known comes.
  static Status check_circles(Scope& scope) {
    for (const bool attachment : {true, false}) {
      for (auto& [name, member] : scope.members()) member.state = 0;
      for (auto& [name, member] : scope.members()) {
        std::vector<Scope::Member*> walked;
        Scope::Member* at = &member;
        while (at && at->state == 0) {
          at->state = 1;
          walked.push_back(at);
          const std::string origin = origin_of(*at->element, attachment);
          at = scope.member(origin);
        }
        if (at && at->state == 1) {
          const Xml* const pose = at->element->child("pose");
          const bool by_pose = !attachment && pose && pose->attribute("relative_to");
          return (by_pose ? *pose : *at->element)
              .error("the frame '" + *at->element->attribute("name") +
                     "' is defined by itself, in a circle of " +
                     (attachment ? "attached_to" : "relative_to"));
        }
        for (Scope::Member* done : walked) done->state = 2;
      }
    }
    return {};
  }

  std::map<const Xml*, Scope> scopes_;
};

}  // namespace

const Xml* main_element(const Xml& root) {
  const Xml* const world = root.child("world");
  return world ? world : root.child("model");
}

Status check_names(const Xml& root) {
  const Xml* const main = main_element(root);
  if (!main) return root.error("there is no <world> and no <model> in this file");
  Checker checker;
  if (main->name == "model") {
    SL_ASSIGN([[maybe_unused]] const std::string name, own_name(*main));
    SL_TRY(checker.check_inner(*main, "placement_frame"));
    SL_TRY(checker.check_inner(*main, "canonical_link"));
  }
  return checker.check(*main, 0);
}

}  // namespace sandlot::formats
