#include "formats/sdf/frames.h"

#include <map>
#include <memory>

#include "base/check.h"
#include "base/text.h"
#include "formats/sdf/values.h"

namespace sandlot::formats {
namespace {

/// The value of an attribute, "" when it is not set.
std::string get(const Xml* element, const char* key) {
  const std::string* const value = element ? element->attribute(key) : nullptr;
  return value ? *value : "";
}

/// A world or model with the things in it that have a frame: links, joints, frames, models.
struct Scope {
  explicit Scope(const Xml& element_) : element(&element_) {
    // A joint may have the name of a link, which is then the one that is meant.
    for (const bool joints : {false, true})
      for (const Xml& child : element->children)
        if (joints ? child.name == "joint"
                   : child.name == "link" || child.name == "frame" || child.name == "model")
          members.emplace(*child.attribute("name"), &child);
    for (const Xml& child : element->children)
      if (child.name == "model") models.emplace(&child, std::make_unique<Scope>(child));
    canonical = get(element, "canonical_link");
    for (const char* const kind : {"link", "model"})
      if (const Xml* const first = element->child(kind); first && canonical.empty())
        canonical = *first->attribute("name");
  }
  const Xml* element;
  std::map<std::string, const Xml*, std::less<>> members;
  std::map<const Xml*, std::unique_ptr<Scope>> models;
  std::string canonical;  ///< the link or model that the scope's own frame is fixed to
};

/// A member of a scope.
struct Entity {
  const Scope* scope;
  const Xml* element;
};

bool walk(const Scope& scope, std::string_view name, std::vector<Entity>& path) {
  if (name.empty() || name == "__model__" || name == "world" || name == "__root__") return true;
  if (const auto found = scope.members.find(name); found != scope.members.end()) {
    path.push_back({&scope, found->second});
    return true;
  }
  for (std::size_t at = name.rfind("::"); at != std::string_view::npos && at > 0;
       at = name.rfind("::", at - 1)) {
    const auto found = scope.members.find(name.substr(0, at));
    const auto model = found == scope.members.end() ? scope.models.end() : scope.models.find(found->second);
    if (model == scope.models.end()) continue;
    path.push_back({&scope, found->second});
    if (walk(*model->second, name.substr(at + 2), path)) return true;
    path.pop_back();
  }
  return false;
}

/// The members that a name passes through: `a::b` is a member of that name, else model a, then its member b. Empty for
/// the scope's own frame.
std::vector<Entity> path_of(const Scope& scope, std::string_view name) {
  std::vector<Entity> path;
  if (!walk(scope, name, path)) path.clear();
  return path;
}

/// What the pose of a member is relative to, as a name in its scope; "" for the scope itself.
std::string origin_of(const Xml& element) {
  if (std::string relative = get(element.child("pose"), "relative_to"); !relative.empty()) return relative;
  if (element.name == "frame") return get(&element, "attached_to");
  if (element.name == "joint") return element.child("child")->text;
  return "";
}

class Resolver {
 public:
  ResolvedFrames out;

  Status resolve(const Scope& scope) {
    for (const Xml& child : scope.element->children) {
      const bool moved = !get(child.child("pose"), "relative_to").empty();
      const Entity entity{&scope, &child};
      if (child.name == "link") {
        if (moved) SL_TRY(place(entity));
        SL_TRY(resolve_parts(entity));
      } else if (child.name == "joint") {
        SL_TRY(resolve_joint(entity, moved));
      } else if (child.name == "frame") {
        const std::string body = body_of(scope, *child.attribute("name"));
        SL_ASSIGN(const Pose X_SF, pose_in_scope(entity));
        SL_ASSIGN(const Pose X_SB, pose_of(scope, body));
        out.poses[&child] = inverse(X_SB) * X_SF;
        out.frame_links[&child] = body;
      } else if (child.name == "model") {
        if (moved || !get(&child, "placement_frame").empty()) SL_TRY(place(entity));
        SL_TRY(resolve(*scope.models.at(&child)));
      } else if (child.name == "light" && moved) {
        SL_ASSIGN(const Pose X_SR, pose_of(scope, get(child.child("pose"), "relative_to")));
        SL_ASSIGN(const Pose X_RP, read_child_pose(child));
        out.poses[&child] = X_SR * X_RP;
      }
    }
    return {};
  }

 private:
  Status place(const Entity& entity) {
    SL_ASSIGN(const Pose X, pose_in_scope(entity));
    out.poses[entity.element] = X;
    return {};
  }

  /// Collisions, visuals, sensors and lights of a link or joint.
  Status resolve_parts(const Entity& owner) {
    for (const Xml& part : owner.element->children) {
      if (part.name != "collision" && part.name != "visual" && part.name != "sensor" && part.name != "light")
        continue;
      const std::string relative = get(part.child("pose"), "relative_to");
      if (relative.empty()) continue;
      SL_ASSIGN(const Pose X_SO, pose_in_scope(owner));
      SL_ASSIGN(const Pose X_SR, pose_of(*owner.scope, relative));
      SL_ASSIGN(const Pose X_RP, read_child_pose(part));
      out.poses[&part] = inverse(X_SO) * X_SR * X_RP;
    }
    return {};
  }

  Status resolve_joint(const Entity& joint, bool moved) {
    const Xml& element = *joint.element;
    const Scope& scope = *joint.scope;
    const std::string& child = element.child("child")->text;
    const std::string child_link = body_of(scope, child);
    if (child_link != child) out.child_links[&element] = child_link;
    if (const std::string& parent = element.child("parent")->text; parent != "world")
      if (const std::string parent_link = body_of(scope, parent); parent_link != parent)
        out.parent_links[&element] = parent_link;
    if (moved || child_link != child) {
      SL_ASSIGN(const Pose X_SC, pose_of(scope, child_link));
      SL_ASSIGN(const Pose X_SJ, pose_in_scope(joint));
      out.poses[&element] = inverse(X_SC) * X_SJ;
    }
    for (const char* const key : {"axis", "axis2"}) {
      const Xml* const axis = element.child(key);
      const Xml* const xyz = axis ? axis->child("xyz") : nullptr;
      const std::string frame = get(xyz, "expressed_in");
      if (frame.empty()) continue;
      SL_ASSIGN(const Pose X_SJ, pose_in_scope(joint));
      SL_ASSIGN(const Pose X_SE, pose_of(scope, frame));
      SL_ASSIGN(const Vec3 direction, read_vec3(*xyz, position_range));
      out.axes[axis] = rotate_inverse(X_SJ.q, rotate(X_SE.q, direction));
    }
    return resolve_parts(joint);
  }

  /// Pose of whatever a name stands for in the scope's own frame.
  Result<Pose> pose_of(const Scope& scope, std::string_view name) {
    Pose X;
    for (const Entity& entity : path_of(scope, name)) {
      SL_ASSIGN(const Pose X_next, pose_in_scope(entity));
      X = X * X_next;
    }
    return X;
  }

  /// Pose of a member in its scope. Chains of relative_to may be as long as the file, so they are followed with a
  /// stack of our own.
  Result<Pose> pose_in_scope(const Entity& wanted) {
    std::vector<Entity> stack{wanted};
    while (!stack.empty()) {
      const Entity entity = stack.back();
      if (known_.count(entity.element) > 0) {
        stack.pop_back();
        continue;
      }
      const std::vector<Entity> base = path_of(*entity.scope, origin_of(*entity.element));
      const std::string placed = entity.element->name == "model" ? get(entity.element, "placement_frame")
                                                                 : "";
      const std::vector<Entity> inner = placed.empty()
                                            ? std::vector<Entity>{}
                                            : path_of(*entity.scope->models.at(entity.element), placed);
      const std::size_t size = stack.size();
      for (const auto* const path : {&base, &inner})
        for (const Entity& each : *path)
          if (known_.count(each.element) == 0) stack.push_back(each);
      if (stack.size() > size) continue;
      Pose X;
      for (const Entity& each : base) X = X * known_.at(each.element);
      SL_ASSIGN(const Pose written, read_child_pose(*entity.element));
      X = X * written;
      // The pose of a model with a placement frame is that frame's.
      Pose X_MP;
      for (const Entity& each : inner) X_MP = X_MP * known_.at(each.element);
      X = X * inverse(X_MP);
      X.q = normalised(X.q);
      if (!is_finite(X)) return entity.element->error("this pose is not finite");
      known_.emplace(entity.element, X);
      stack.pop_back();
    }
    return known_.at(wanted.element);
  }

  /// The link that a name is fixed to, as a name in the scope: frames hand on to what they are attached to, joints to
  /// their child, models to their canonical link. "world" in a world; "" in a model without links, which is refused
  /// when it is read.
  std::string body_of(const Scope& scope, const std::string& name) {
    std::vector<const Xml*> walked;
    std::string rest = name, body;
    for (;;) {
      const std::vector<Entity> path = path_of(scope, rest);
      if (path.empty()) {
        if (scope.element->name == "world") body = "world";
        if (scope.element->name == "world" || scope.canonical.empty()) break;
        rest = scope.canonical;
        continue;
      }
      const Xml& element = *path.front().element;
      const std::string& own = *element.attribute("name");
      if (element.name == "model") {
        const std::string inner = path.size() > 1 ? body_of(*path[1].scope, name_from(path, 1))
                                                  : body_of(*scope.models.at(&element), "");
        body = inner.empty() ? "" : own + "::" + inner;
        break;
      }
      if (element.name == "link") {
        body = own;
        break;
      }
      if (const auto known = bodies_.find(&element); known != bodies_.end()) {
        body = known->second;
        break;
      }
      walked.push_back(&element);
      rest = element.name == "joint" ? element.child("child")->text : get(&element, "attached_to");
    }
    for (const Xml* const each : walked) bodies_.emplace(each, body);
    return body;
  }
  static std::string name_from(const std::vector<Entity>& path, std::size_t first) {
    std::string name;
    for (std::size_t i = first; i < path.size(); ++i)
      name += (i > first ? "::" : "") + *path[i].element->attribute("name");
    return name;
  }

  std::unordered_map<const Xml*, Pose> known_;
  std::unordered_map<const Xml*, std::string> bodies_;  ///< of frames and joints, in their scope
};

}  // namespace

Result<ResolvedFrames> resolve_frames(const Xml& root) {
  const Scope scope(*main_element(root));
  Resolver resolver;
  SL_TRY(resolver.resolve(scope));
  // The pose of a model file's own model is its <pose>, unless that is the pose of a frame inside.
  if (const Xml& main = *scope.element; main.name == "model" && !get(&main, "placement_frame").empty()) {
    Xml world;
    world.name = "world";
    world.children.push_back(main);
    const Scope outer(world);
    Resolver placing;
    SL_TRY(placing.resolve(outer));
    resolver.out.poses[&main] = placing.out.poses.at(&world.children.front());
  }
  return std::move(resolver.out);
}

}  // namespace sandlot::formats
