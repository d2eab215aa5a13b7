#include "formats/sdf/frames.h"

#include <mutex>
#include <ostream>

#include <sdf/sdf.hh>

#include "base/text.h"
#include "formats/sdf/values.h"

namespace sandlot::formats {
namespace {

/// libsdformat writes its complaints to a process-wide console; this keeps them from the user, who gets ours.
class QuietConsole {
 public:
  QuietConsole() : lock_(mutex()), console_(sdf::Console::Instance()), nowhere_(nullptr) {
    message_ = console_->GetMsgStream().GetStream();
    log_ = console_->GetLogStream().GetStream();
    console_->GetMsgStream().SetStream(&nowhere_);
    console_->GetLogStream().SetStream(&nowhere_);
  }
  ~QuietConsole() {
    console_->GetMsgStream().SetStream(message_);
    console_->GetLogStream().SetStream(log_);
  }
  QuietConsole(const QuietConsole&) = delete;
  QuietConsole& operator=(const QuietConsole&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex the_mutex;
    return the_mutex;
  }
  std::lock_guard<std::mutex> lock_;
  sdf::ConsolePtr console_;
  std::ostream nowhere_;
  std::ostream* message_ = nullptr;
  std::ostream* log_ = nullptr;
};

bool is_set(const Xml& element, const char* key) {
  const std::string* const value = element.attribute(key);
  return value && !value->empty();
}

/// Is anything in here given relative to something else than its parent?
bool needs_resolving(const Xml& element) {
  if (element.name == "frame" || is_set(element, "placement_frame")) return true;
  if (element.name == "pose" && is_set(element, "relative_to")) return true;
  if (element.name == "xyz" && is_set(element, "expressed_in")) return true;
  if (element.name == "joint")
    for (const char* const end : {"parent", "child"}) {
      const Xml* const named = element.child(end);
      if (named && (named->text == "__model__" || named->text.find("::") != std::string::npos)) return true;
    }
  for (const Xml& child : element.children)
    if (needs_resolving(child)) return true;
  return false;
}

/// The part of a document that libsdformat needs to place things: names and poses, one element per line, so that its
/// line numbers lead back to our elements. Rotations go as quaternions: theirs would be computed with libm.
class Skeleton {
 public:
  Status write(const Xml& root) {
    line("<sdf version='1.9'>", root);
    SL_TRY(write_scope(*main_element(root)));
    text_ += "</sdf>";
    return {};
  }
  const std::string& text() const { return text_; }
  const Xml* at_line(int line_number) const {
    const auto index = static_cast<std::size_t>(line_number - 1);
    return line_number >= 1 && index < lines_.size() ? lines_[index] : nullptr;
  }

 private:
  void line(const std::string& text, const Xml& element) {
    text_ += text + "\n";
    lines_.push_back(&element);
  }
  static std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
      if (c == '<' || c == '>' || c == '&' || c == '\'' || c == '"' || static_cast<unsigned char>(c) < 0x20)
        out += "&#" + std::to_string(static_cast<unsigned char>(c)) + ";";
      else
        out += c;
    }
    return out;
  }
  static std::string attribute(const Xml& element, const char* key) {
    return is_set(element, key) ? " " + std::string(key) + "='" + escaped(*element.attribute(key)) + "'" : "";
  }
  static std::string number(double x) { return number_text(x) + " "; }
  Status write_pose(const Xml& owner) {
    const Xml* const element = owner.child("pose");
    if (!element) return {};
    SL_ASSIGN(const Pose X, read_sdf_pose(*element));
    line("<pose rotation_format='quat_xyzw'" + attribute(*element, "relative_to") + ">" + number(X.p.x) + number(X.p.y) +
             number(X.p.z) + number(X.q.x) + number(X.q.y) + number(X.q.z) + number(X.q.w) + "</pose>",
         *element);
    return {};
  }
  Status write_scope(const Xml& scope) {
    const bool world = scope.name == "world";
    line("<" + scope.name + (world ? std::string(" name='w'") : attribute(scope, "name")) + attribute(scope, "canonical_link") +
             attribute(scope, "placement_frame") + ">",
         scope);
    if (!world) SL_TRY(write_pose(scope));
    for (const Xml& child : scope.children) {
      if (child.name == "model") SL_TRY(write_scope(child));
      if (child.name == "frame") SL_TRY(write_named(child, attribute(child, "attached_to")));
      if (child.name == "link" && !world) SL_TRY(write_link(child));
      if (child.name == "joint" && !world) SL_TRY(write_joint(child));
    }
    line("</" + scope.name + ">", scope);
    return {};
  }
  Status write_named(const Xml& element, const std::string& more, const std::string& content = "") {
    line("<" + element.name + attribute(element, "name") + more + ">" + content, element);
    SL_TRY(write_pose(element));
    line("</" + element.name + ">", element);
    return {};
  }
  Status write_link(const Xml& link) {
    line("<link" + attribute(link, "name") + ">", link);
    SL_TRY(write_pose(link));
    for (const Xml& child : link.children) {
      if (child.name == "collision" || child.name == "visual")
        SL_TRY(write_named(child, "", "<geometry><empty/></geometry>"));
      if (child.name == "sensor") SL_TRY(write_named(child, " type='custom'"));
    }
    line("</link>", link);
    return {};
  }
  Status write_joint(const Xml& joint) {
    const Xml* const axis = joint.child("axis");
    const Xml* const xyz = axis ? axis->child("xyz") : nullptr;
    line("<joint" + attribute(joint, "name") + " type='" + (axis ? "revolute" : "fixed") + "'>", joint);
    for (const char* const end : {"parent", "child"})
      line("<" + std::string(end) + ">" + escaped(joint.child(end)->text) + "</" + end + ">", *joint.child(end));
    SL_TRY(write_pose(joint));
    if (axis) {
      Vec3 direction{0, 0, 1};
      if (xyz) {
        SL_ASSIGN(direction, read_vec3(*xyz, position_range));
        if (!(norm(direction) > 1e-6)) return xyz->error("the axis of this joint is zero", "write 0 0 1");
      }
      line("<axis><xyz" + (xyz ? attribute(*xyz, "expressed_in") : std::string()) + ">" + number(direction.x) +
               number(direction.y) + number(direction.z) + "</xyz></axis>",
           xyz ? *xyz : *axis);
    }
    for (const Xml& child : joint.children)
      if (child.name == "sensor") SL_TRY(write_named(child, " type='custom'"));
    line("</joint>", joint);
    return {};
  }

  std::string text_;
  std::vector<const Xml*> lines_;
};

Vec3 from_ignition(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }
Pose from_ignition(const ignition::math::Pose3d& X) {
  return {from_ignition(X.Pos()), normalised(Quat{X.Rot().W(), X.Rot().X(), X.Rot().Y(), X.Rot().Z()})};
}

/// Walks our elements and libsdformat's objects side by side.
class Resolver {
 public:
  explicit Resolver(const Skeleton& skeleton) : skeleton_(skeleton) {}
  ResolvedFrames out;

  Error complaint(const sdf::Errors& errors, const Xml& near) const {
    for (const sdf::Error& error : errors)
      if (const Xml* const element = error.LineNumber() ? skeleton_.at_line(*error.LineNumber()) : nullptr)
        return element->error(error.Message());
    return near.error(errors.empty() ? "this cannot be placed" : errors.front().Message());
  }

  Status world(const Xml& element, const sdf::World& world) {
    for (const Xml& child : element.children)
      if (child.name == "model") {
        const sdf::Model* const object = world.ModelByName(*child.attribute("name"));
        if (!object) return child.error("this model cannot be placed");
        SL_TRY(model(child, *object));
      }
    return {};
  }

  Status model(const Xml& element, const sdf::Model& model_) {
    SL_TRY(pose(element, model_.SemanticPose()));
    for (const Xml& child : element.children) {
      if (child.name == "model") {
        const sdf::Model* const object = model_.ModelByName(*child.attribute("name"));
        if (!object) return child.error("this model cannot be placed");
        SL_TRY(model(child, *object));
      } else if (child.name == "link") {
        SL_TRY(link(child, model_));
      } else if (child.name == "joint") {
        SL_TRY(joint(child, model_));
      } else if (child.name == "frame") {
        const sdf::Frame* const object = model_.FrameByName(*child.attribute("name"));
        if (!object) return child.error("this frame cannot be placed");
        std::string body;
        if (const sdf::Errors errors = object->ResolveAttachedToBody(body); !errors.empty()) return complaint(errors, child);
        SL_TRY(pose(child, object->SemanticPose(), body));
        out.frame_links[&child] = body;
      }
    }
    return {};
  }

 private:
  Status pose(const Xml& element, const sdf::SemanticPose& semantic, const std::string& in = "") {
    ignition::math::Pose3d X;
    if (const sdf::Errors errors = semantic.Resolve(X, in); !errors.empty()) return complaint(errors, element);
    const Pose found = from_ignition(X);
    if (!is_finite(found)) return element.error("this pose is not finite");
    out.poses[&element] = found;
    return {};
  }

  Status link(const Xml& element, const sdf::Model& model) {
    const sdf::Link* const object = model.LinkByName(*element.attribute("name"));
    if (!object) return element.error("this link cannot be placed");
    SL_TRY(pose(element, object->SemanticPose()));
    for (const Xml& child : element.children) {
      const std::string* const name = child.attribute("name");
      if (!name) continue;
      const sdf::Collision* const collision = child.name == "collision" ? object->CollisionByName(*name) : nullptr;
      const sdf::Visual* const visual = child.name == "visual" ? object->VisualByName(*name) : nullptr;
      const sdf::Sensor* const sensor = child.name == "sensor" ? object->SensorByName(*name) : nullptr;
      if (collision) SL_TRY(pose(child, collision->SemanticPose()));
      if (visual) SL_TRY(pose(child, visual->SemanticPose()));
      if (sensor) SL_TRY(pose(child, sensor->SemanticPose()));
    }
    return {};
  }

  Status joint(const Xml& element, const sdf::Model& model) {
    const sdf::Joint* const object = model.JointByName(*element.attribute("name"));
    if (!object) return element.error("this joint cannot be placed");
    std::string& child = out.child_links[&element];
    std::string& parent = out.parent_links[&element];
    if (const sdf::Errors errors = object->ResolveChildLink(child); !errors.empty()) return complaint(errors, element);
    if (const sdf::Errors errors = object->ResolveParentLink(parent); !errors.empty()) return complaint(errors, element);
    SL_TRY(pose(element, object->SemanticPose(), child));
    if (const sdf::JointAxis* const axis = object->Axis(0)) {
      ignition::math::Vector3d direction;
      if (const sdf::Errors errors = axis->ResolveXyz(direction); !errors.empty()) return complaint(errors, element);
      out.axes[element.child("axis")] = from_ignition(direction);
    }
    for (const Xml& sensor : element.children)
      if (sensor.name == "sensor")
        if (const sdf::Sensor* const found = object->SensorByName(*sensor.attribute("name")))
          SL_TRY(pose(sensor, found->SemanticPose()));
    return {};
  }

  const Skeleton& skeleton_;
};

}  // namespace

Result<ResolvedFrames> resolve_frames(const Xml& root) {
  if (!needs_resolving(*main_element(root))) return ResolvedFrames{};
  Skeleton skeleton;
  SL_TRY(skeleton.write(root));
  const QuietConsole quiet;
  sdf::ParserConfig config;
  config.SetWarningsPolicy(sdf::EnforcementPolicy::LOG);
  sdf::Root parsed;
  const sdf::Errors errors = parsed.LoadSdfString(skeleton.text(), config);
  Resolver resolver(skeleton);
  if (!errors.empty()) return resolver.complaint(errors, root);
  const Xml& main = *main_element(root);
  const sdf::World* const world = main.name == "world" ? parsed.WorldByIndex(0) : nullptr;
  if (main.name == "world" ? !world : !parsed.Model()) return main.error("this " + main.name + " cannot be placed");
  SL_TRY(world ? resolver.world(main, *world) : resolver.model(main, *parsed.Model()));
  return std::move(resolver.out);
}

}  // namespace sandlot::formats
