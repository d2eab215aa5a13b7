#pragma once
/// Contact sensor: what touches the shapes of a link, where and how hard; and the bumper switch made of it.
///
/// Frame    points, normals and forces in the world.
/// Levels   `contacts` (the default): sandlot_msgs/ContactsState, one entry per pair of shapes: points,
///          normals towards the own shape, depths, and the force on the own shape at each point. `bumper`:
///          std_msgs/Bool. Both may be active.
/// Time     contacts are those of the last physics step of the tick, forces means over it. The bumper shows
///          whether the force on it was at least `threshold` in any physics step since its previous sample: a
///          blow between two samples is not lost.
/// Noise    none.
/// Limits   the planar engine merges the shapes of a robot into one disc, which stands for all its links, and
///          reports no forces: they read zero. Names are "<robot>::<link>::<collision>".
/// Cost     nothing but a look at the list of contacts where nothing touches; the engine measures the forces
///          of this link only. Strings of names are written when something touches; capacity is reused.
/// Errors   a collision that the link does not have; a threshold on an engine that reports no forces.
/// Source   SDF 1.9 <sensor type="contact">; message after gazebo_msgs/ContactsState.
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::contact {

struct Spec {
  std::vector<std::string> collision;
  double threshold_N = 0;
  double rate_hz = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"collision", "", "Names of the link's collisions that are sensitive; not given: all.", 0, 0,
                0, 1000},
          s.collision);
    visit(
        Field{"threshold", "N", "Force that closes the bumper; 0: any contact does.", 0, 1e9, Field::tunable},
        s.threshold_N);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

enum Level : std::uint32_t { contacts, bumper };

struct State {
  bool pressed = false;  ///< since the previous sample

  static void fields(auto& s, auto&& visit) {
    visit(Field{"pressed", "", "Whether the bumper was closed since the previous sample."}, s.pressed);
  }
};

struct Sensor {
  using Spec = contact::Spec;
  using State = contact::State;
  Spec spec;
  State state;

  BodyId body;
  std::vector<bool> feels;  ///< per collision of the link
  bool merged = false;      ///< the engine has one shape for the whole robot
  Topic<msg::ContactsState>* contacts = nullptr;
  Topic<msg::Bool>* bumper = nullptr;

  static Result<Sensor> create(const DeviceBuild& build, Spec spec);
  static void pre_substep(PoolView<Sensor> pool, const Context& context, double h_s);
  static void post_substep(PoolView<Sensor> pool, const Context& context, double h_s);
  static void sense(PoolView<Sensor> pool, const Context& context);

  /// +1: the contact's b is felt, -1: its a, 0: neither.
  int side(const Contact& contact) const;
};

extern const Kind kind;

}  // namespace sandlot::contact
