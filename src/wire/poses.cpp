#include <algorithm>
#include <limits>

#include "base/bytes.h"
#include "base/math.h"
#include "kinematics/tree.h"
#include "wire/scene.h"

namespace sandlot::wire {

/// Kinematic tree of a model, which it keeps alive.
struct LinkTree {
  std::shared_ptr<const model::Model> model;
  kinematics::KinematicTree tree;
};

namespace {

using Bytes = std::vector<std::byte>;
using kinematics::KinematicTree;
using model::JointType;

/// How far off a viewer may draw a link for its pose to be sent as joint positions.
constexpr double most_off_m = 1e-3, most_off_rad = 0.01;

void put(Bytes& out, const auto& value) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}
float narrowed(double x) {
  constexpr double most = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(x, -most, most));
}
/// Appends, and returns what a viewer reads.
double put_float(Bytes& out, double x) {
  const float f = narrowed(x);
  put(out, f);
  return f;
}
Vec3 put_vector(Bytes& out, Vec3 v) {
  const double x = put_float(out, v.x), y = put_float(out, v.y), z = put_float(out, v.z);
  return {x, y, z};
}

/// Three components of 15 bits in +-1/sqrt(2); the fourth, of largest magnitude, follows from them.
Quat put_orientation(Bytes& out, Quat q) {
  q = normalised(q);
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i)
    if (std::abs(q[i]) > std::abs(q[largest])) largest = i;
  const double sign = q[largest] < 0 ? -1 : 1;
  std::uint64_t bits = largest;
  Quat decoded;
  double sum = 0;
  int shift = 2;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const double scaled = std::round((sign * q[i] * std::sqrt(2.0) + 1) / 2 * 32767);
    const auto n = static_cast<std::uint64_t>(std::clamp(scaled, 0.0, 32767.0));
    bits |= n << shift;
    shift += 15;
    decoded[i] = (static_cast<double>(n) / 32767 * 2 - 1) / std::sqrt(2.0);
    sum += decoded[i] * decoded[i];
  }
  decoded[largest] = std::sqrt(std::max(0.0, 1 - sum));
  for (int i = 0; i < 6; ++i) put(out, static_cast<std::uint8_t>(bits >> (8 * i)));
  return decoded;
}

Pose put_pose(Bytes& out, const Pose& X) {
  const Vec3 p = put_vector(out, X.p);
  return {p, put_orientation(out, X.q)};
}

double put_angle(Bytes& out, double rad) {
  const double turns = std::round(rad / math::tau * 65536);
  const auto n = static_cast<std::uint16_t>(static_cast<std::int64_t>(turns) & 0xFFFF);
  put(out, n);
  return n * math::tau / 65536;
}

/// Appends what a joint does; returns the motion that a viewer makes of it.
/// @param X_PC  of the child in the parent
Pose put_joint(Bytes& out, const model::Joint& joint, const KinematicTree::Branch& link, const Pose& X_PC) {
  const auto position = [&] {
    return kinematics::joint_position(joint, inverse(link.X_PJ) * X_PC * inverse(link.X_JL));
  };
  switch (joint.type) {
    case JointType::fixed: return {};
    case JointType::revolute:
    case JointType::continuous: return kinematics::joint_motion(joint, put_angle(out, position()));
    case JointType::prismatic:
    case JointType::screw: return kinematics::joint_motion(joint, put_float(out, position()));
    case JointType::ball:
    case JointType::universal: break;
  }
  const Quat q_PC = put_orientation(out, X_PC.q);
  return {{}, conjugate(link.X_PJ.q) * q_PC * conjugate(link.X_JL.q)};
}

bool near(const Pose& a, const Pose& b) {
  const double cos_half = std::abs(a.q.w * b.q.w + a.q.x * b.q.x + a.q.y * b.q.y + a.q.z * b.q.z);
  return norm(a.p - b.p) <= most_off_m && cos_half >= 1 - most_off_rad * most_off_rad / 8;
}

}  // namespace

PoseWriter::PoseWriter() = default;
PoseWriter::~PoseWriter() = default;
PoseWriter::PoseWriter(PoseWriter&&) noexcept = default;
PoseWriter& PoseWriter::operator=(PoseWriter&&) noexcept = default;

std::shared_ptr<const LinkTree> PoseWriter::tree_of(const std::shared_ptr<const model::Model>& model) {
  auto& tree = trees_[model.get()];  // a tree keeps its model, so the address is that of no other
  if (!tree) tree = std::make_shared<const LinkTree>(LinkTree{model, kinematics::forward_tree(*model)});
  return tree;
}

bool PoseWriter::encode_joints(const FrameInstance& instance, const LinkTree& tree, Bytes& out) {
  const std::size_t count = tree.model->links.size();
  decoded_.resize(count);  // first each link's motion, or its pose where no joint carries it; then all poses
  decoded_[0] = put_pose(out, instance.X_WL[0]);
  for (std::size_t i = 1; i < count; ++i) {
    const KinematicTree::Branch& link = tree.tree.branches[tree.tree.branch_of[i]];
    decoded_[i] = link.joint == KinematicTree::none
                      ? put_pose(out, instance.X_WL[i])
                      : put_joint(out, tree.model->joints[link.joint], link,
                                  inverse(instance.X_WL[link.parent]) * instance.X_WL[i]);
  }
  for (const KinematicTree::Branch& link : tree.tree.branches) {
    if (link.joint == KinematicTree::none) continue;
    Pose& X_WL = decoded_[link.link];
    X_WL = decoded_[link.parent] * link.X_PJ * X_WL * link.X_JL;
    if (!near(X_WL, instance.X_WL[link.link])) return false;
  }
  return true;
}

void PoseWriter::encode(const FrameInstance& instance, const LinkTree& tree, Bytes& out) {
  out.clear();
  put(out, static_cast<std::uint32_t>(instance.serial));
  put(out, std::uint8_t{0});
  if (encode_joints(instance, tree, out)) return;
  // A joint gave way under load, or turned about an axis that nobody sends.
  out.resize(5);
  out[4] = std::byte{1};
  for (const Pose& X_WL : instance.X_WL) put_pose(out, X_WL);
}

bool PoseWriter::write(const Frame& frame, std::uint64_t epoch, bool key, Bytes& out) {
  if (epoch != epoch_) {
    entries_.clear();
    trees_.clear();
    key = true;
  }
  epoch_ = epoch;
  ++round_;
  out.clear();
  put(out, std::uint8_t{1});
  put(out, static_cast<std::uint8_t>(key ? 1 : 0));
  put(out, static_cast<std::uint16_t>(epoch));
  put(out, static_cast<std::uint32_t>(frame.revision));
  put(out, frame.tick);
  put(out, frame.now.ns);
  const std::size_t count_at = out.size();
  put(out, std::uint32_t{0});
  std::uint32_t count = 0;
  for (const FrameInstance& instance : frame.instances) {
    if (instance.X_WL.empty() || instance.X_WL.size() != instance.model->links.size()) continue;
    Entry& entry = entries_[instance.serial];
    entry.round = round_;
    const bool is_new = !entry.tree || entry.tree->model != instance.model;
    if (is_new) entry.tree = tree_of(instance.model);
    // What rests is neither written nor compared byte by byte.
    if (is_new || entry.X_WL != instance.X_WL) {
      entry.X_WL = instance.X_WL;
      encode(instance, *entry.tree, record_);
      const bool same = !is_new && record_ == entry.record;
      std::swap(record_, entry.record);
      if (same && !key) continue;
    } else if (!key) {
      continue;
    }
    out.insert(out.end(), entry.record.begin(), entry.record.end());
    ++count;
  }
  std::memcpy(out.data() + count_at, &count, sizeof count);
  if (frame.revision != revision_) forget_those_gone();
  revision_ = frame.revision;
  return count > 0;
}

void PoseWriter::forget_those_gone() {
  std::erase_if(entries_, [&](const auto& each) { return each.second.round != round_; });
  std::erase_if(trees_, [](const auto& each) { return each.second.use_count() == 1; });
}

}  // namespace sandlot::wire
