#pragma once
/// The border between the simulator and a kind of device (sensor or actuator).
///
/// A kind is one folder under devices/ and one line in devices/kinds.h. It writes a struct
///   struct Device {                       // one device in the pool
///     using Spec = ...;                   // named fields with a field list; constant but for tunable fields
///     using State = ...;                  // plain data with a field list: all that changes
///     Spec spec; State state;
///     Boxed<Late> late;          // only where some devices come to have more State: no bytes while it is empty
///     ...                                 // what create() resolved: handles, topics
///     static Result<Device> create(const DeviceBuild&, Spec);
///     static void sense(PoolView<Device>, const Context&);    // and/or actuate, pre_substep, post_substep, switch_level
///     static void settle(PoolView<Device>, const Context&);   // batteries: between physics and sensing, once per tick
///     void restored();      // only where something beside State follows from it: called after State was loaded
///     bool fits() const;    // only where sizes in State or messages are trusted: false refuses a snapshot
///     std::uint64_t changes() const;  // only of a large State that seldom changes: grows when a phase other than sense does it
///   };
/// and `const Kind kind = make_kind<Device>({...})`. Reading the spec, hashing, snapshots, parameters while
/// running, `sandlot list`, the schema and the docs follow from the field lists. All devices of a kind live
/// in one pool: one call per kind and phase, not per device. A Spec with a member `errors` (noise/chain.h,
/// errors_field) takes part in the factors that scenarios and robots put on the errors of all their devices:
/// while a phase function runs it is the product of all factors, before and after it is the device's own.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/describe.h"
#include "base/random.h"
#include "base/read.h"
#include "base/time.h"
#include "devices/context.h"
#include "devices/device_build.h"
#include "devices/device_service.h"
#include "devices/device_state.h"
#include "devices/scaled_errors.h"
#include "devices/shared_spec.h"
#include "physics/engine.h"

namespace sandlot {

/// Bumped when the structs below change; plugins built against another version are refused.
inline constexpr int device_api_version = 10;

/// The devices a phase function works on: `all`, of which the indices `due` are to be served now.
/// For actuate, pre_substep and post_substep every device is due.
template <class Device>
struct PoolView {
  std::span<Device> all;
  std::span<const std::uint32_t> due;
  std::span<const std::uint64_t> sample;  ///< per device in `all`: index of the sample to take, counts from 0
  std::span<const std::uint32_t> levels;  ///< per device in `all`: active levels as bits
  std::span<const Time> since;            ///< per device in `all`: time since its previous sample
};

/// Type-erased pool; `make_kind` writes it.
class PoolBase {
 public:
  virtual ~PoolBase() = default;
  /// Reads and checks the declaration, builds the device at the end of the pool.
  virtual Status add(const DeviceBuild& build) = 0;
  /// Removes one device; those behind it move up by one.
  virtual void remove(std::uint32_t index) = 0;
  /// Writes what a removed actuator leaves behind (a joint set free, a base released) to context.actuation.
  virtual void release(std::uint32_t index, const Context& context) = 0;
  virtual double rate_hz(std::uint32_t index) const = 0;  ///< 0: every tick
  /// For a kind: whether its devices have errors; for a device: its own factor on them.
  virtual bool has_errors() const = 0;
  virtual double errors(std::uint32_t index) const = 0;
  /// Multiplier of a device's own factor `errors` in the phases; 1 at first.
  virtual void scale_errors(std::uint32_t index, double factor) = 0;
  struct Due {
    std::span<const std::uint32_t> due;
    std::span<const std::uint64_t> sample;
    std::span<const std::uint32_t> levels;
    std::span<const Time> since;
  };
  virtual void actuate(const Context& context, const Due& due) = 0;
  virtual void pre_substep(const Context& context, const Due& due, double h_s) = 0;
  virtual void post_substep(const Context& context, const Due& due, double h_s) = 0;
  virtual void settle(const Context& context, const Due& due) = 0;
  virtual void sense(const Context& context, const Due& due) = 0;
  /// Hands the State over when the active levels change from `before` to `after`.
  virtual Status switch_level(std::uint32_t index, std::uint32_t before, std::uint32_t after,
                              const Context& context) = 0;
  virtual Status set_parameter(std::uint32_t index, std::string_view path, const Node& value) = 0;
  /// Calls a service of the kind; request and response in CDR.
  virtual Status call(std::uint32_t index, const DeviceService& service, std::span<const std::byte> request,
                      std::vector<std::byte>& response, const Context& context) = 0;
  /// A number of a device's spec or state by its path, and all of them.
  virtual ValueFound value(std::uint32_t index, ValuePart part, std::span<const ValueStep> path) const = 0;
  virtual void list_values(std::uint32_t index, ValuePart part, const ValueVisit& visit) const = 0;
  virtual void save(std::uint32_t index, ByteWriter& w) const = 0;
  virtual void load(std::uint32_t index, ByteReader& r) = 0;
  /// Whether the device can go on with its State and the messages in its topics (Device::fits).
  virtual bool fits(std::uint32_t index) const = 0;
  virtual std::optional<std::uint64_t> changes(std::uint32_t index) const = 0;  ///< Device::changes, if any
};

enum Phases : unsigned { phase_actuate = 1, phase_pre_substep = 2, phase_sense = 4, phase_post_substep = 8 };
inline constexpr unsigned phase_settle = 16;

/// A kind of device. Function pointers and constants only, so that a plugin can fill one.
struct Kind {
  const char* name;  ///< as scenario files spell it: "laser_scanner"
  const char* help;  ///< one sentence
  std::span<const LevelInfo> levels;
  /// SDF and URDF names: "sensor:gpu_lidar", "plugin:DiffDrive" (its class, or its library without "lib" and ".so").
  std::span<const char* const> sdf_types = {};
  /// Turns the SDF element into keys of the spec, `level` and `link`; warns of what it cannot use. Null without sdf_types.
  Result<Node> (*from_sdf)(const Node& element, Diagnostics& diagnostics) = nullptr;
  /// Tells elements of one type apart when several kinds answer to it; null: takes them all.
  bool (*accepts)(const Node& element) = nullptr;
  const char* sdf_note = "";  ///< for the docs: what of those elements has no effect here
  std::span<const Preset> presets = {};
  std::span<const DeviceService> services = {};
  bool needs_render_scene = false;  ///< its devices look at Context::pictures or Context::labelled_objects
  bool stores_energy = false;  ///< its devices are batteries: one per robot, DeviceBuild::account is theirs
  int api_version = device_api_version;
  // Filled by make_kind:
  unsigned phases = 0;
  std::vector<FieldInfo> (*describe)() = nullptr;
  std::unique_ptr<PoolBase> (*create_pool)() = nullptr;
};

template <class Device>
class DevicePool final : public PoolBase {
 public:
  Status add(const DeviceBuild& build) override {
    if constexpr (shares) {
      const Node& config = build.decl.config;
      // Copies of one node are copies of one declaration.
      if (!latest_ || !config.is_map() || &config.entries() != &std::as_const(latest_config_).entries()) {
        auto spec = read_spec<Spec>(config);
        if (!spec) return at_declaration(std::move(spec.error()), build);
        latest_.emplace(std::move(*spec));
        latest_config_ = config;
      }
      return keep(*latest_, build);
    } else {
      auto spec = read_spec<Spec>(build.decl.config);
      if (!spec) return at_declaration(std::move(spec.error()), build);
      return keep(std::move(*spec), build);
    }
  }
  void remove(std::uint32_t index) override {
    devices_.erase(devices_.begin() + index);
    errors_.remove(index);
  }
  bool has_errors() const override { return Errors::exist; }
  double errors([[maybe_unused]] std::uint32_t index) const override {
    if constexpr (Errors::exist) return spec_of(devices_[index]).errors;
    else return 1;
  }
  void scale_errors(std::uint32_t index, double factor) override { errors_.set(index, factor); }
  void release(std::uint32_t index, const Context& context) override {
    if constexpr (requires { devices_[index].release(context); }) devices_[index].release(context);
    else (void)index, (void)context;
  }
  double rate_hz(std::uint32_t index) const override {
    if constexpr (requires(const Spec& s) { s.rate_hz; }) return spec_of(devices_[index]).rate_hz;
    else return 0;
  }
  void actuate([[maybe_unused]] const Context& context, [[maybe_unused]] const Due& due) override {
    if constexpr (requires { &Device::actuate; }) {
      errors_.run(devices_, due.due, [&] { Device::actuate(view(due), context); });
    }
  }
  void pre_substep([[maybe_unused]] const Context& context, [[maybe_unused]] const Due& due,
                   [[maybe_unused]] double h_s) override {
    if constexpr (requires { &Device::pre_substep; }) {
      errors_.run(devices_, due.due, [&] { Device::pre_substep(view(due), context, h_s); });
    }
  }
  void post_substep([[maybe_unused]] const Context& context, [[maybe_unused]] const Due& due,
                    [[maybe_unused]] double h_s) override {
    if constexpr (requires { &Device::post_substep; }) {
      errors_.run(devices_, due.due, [&] { Device::post_substep(view(due), context, h_s); });
    }
  }
  void settle([[maybe_unused]] const Context& context, [[maybe_unused]] const Due& due) override {
    if constexpr (requires { &Device::settle; }) Device::settle(view(due), context);
  }
  void sense([[maybe_unused]] const Context& context, [[maybe_unused]] const Due& due) override {
    if constexpr (requires { &Device::sense; }) {
      errors_.run(devices_, due.due, [&] { Device::sense(view(due), context); });
    }
  }
  Status switch_level(std::uint32_t index, std::uint32_t before, std::uint32_t after,
                      const Context& context) override {
    if constexpr (requires { &Device::switch_level; })
      return devices_[index].switch_level(before, after, context);
    else return (void)index, (void)before, (void)after, (void)context, Status();
  }
  Status call(std::uint32_t index, const DeviceService& service, std::span<const std::byte> request,
              std::vector<std::byte>& response, const Context& context) override {
    Status status;
    errors_.run(devices_, {&index, 1},
                [&] { status = service.call(&devices_[index], request, response, context); });
    return status;
  }
  Status set_parameter(std::uint32_t index, std::string_view path, const Node& value) override {
    Spec changed = spec_of(devices_[index]);
    SL_TRY(set_tunable(changed, path, value));
    set_spec(devices_[index], std::move(changed));
    return {};
  }
  ValueFound value(std::uint32_t index, ValuePart part, std::span<const ValueStep> path) const override {
    const Device& d = devices_[index];
    const ValueFound found = value_at(part, spec_of(d), d.state, path);
    if constexpr (requires { d.late; })
      if (found.is == ValueFound::Is::unknown && part == ValuePart::state && d.late)
        return value_at(*d.late, path);
    return found;
  }
  void list_values(std::uint32_t index, ValuePart part, const ValueVisit& visit) const override {
    const Device& d = devices_[index];
    sandlot::list_values(part, spec_of(d), d.state, visit);
    if constexpr (requires { d.late; })
      if (part == ValuePart::state && d.late) sandlot::list_values(*d.late, "", "", "", visit);
  }
  void save(std::uint32_t index, ByteWriter& w) const override {
    save_device(w, spec_of(devices_[index]), devices_[index]);
  }
  void load(std::uint32_t index, ByteReader& r) override {
    Device& d = devices_[index];
    Spec spec = spec_of(d);
    load_device(r, spec, d);
    set_spec(d, std::move(spec));
    if (!fits(index)) return r.fail();
    if constexpr (requires { d.restored(); }) d.restored();
  }
  bool fits([[maybe_unused]] std::uint32_t index) const override {
    if constexpr (requires { devices_[index].fits(); }) return devices_[index].fits();
    else return true;
  }
  std::optional<std::uint64_t> changes([[maybe_unused]] std::uint32_t index) const override {
    if constexpr (requires { devices_[index].changes(); }) return devices_[index].changes();
    else return {};
  }

 private:
  using Spec = typename Device::Spec;
  using Errors = ScaledErrors<Device>;
  static constexpr bool shares = shares_spec<Device>;
  /// A covariance that create() publishes is that of all factors together; the device keeps its own.
  Status keep(typename Errors::Held spec, const DeviceBuild& build) {
    [[maybe_unused]] const auto own = [&] {
      if constexpr (Errors::exist) return errors_.take(spec, build.errors);
      else return 0;
    }();
    auto device = Device::create(build, std::move(spec));
    if (!device) return at_declaration(std::move(device.error()), build);
    if constexpr (Errors::exist) Errors::give_back(device->spec, own);
    devices_.push_back(std::move(*device));
    errors_.add(build.errors);
    return {};
  }
  static Error at_declaration(Error error, const DeviceBuild& build) {
    if (!error.place.file && error.place.line == 0) error.place = build.decl.place;
    return error;
  }
  PoolView<Device> view(const Due& due) { return {devices_, due.due, due.sample, due.levels, due.since}; }
  std::vector<Device> devices_;
  struct None {};
  [[no_unique_address]] std::conditional_t<shares, std::optional<SharedSpec<Spec>>, None> latest_;
  [[no_unique_address]] std::conditional_t<shares, Node, None> latest_config_;
  Errors errors_;
};

template <class Device>
constexpr Kind make_kind(Kind kind) {
  kind.phases = (requires { &Device::actuate; } ? phase_actuate : 0u) |
                (requires { &Device::pre_substep; } ? phase_pre_substep : 0u) |
                (requires { &Device::post_substep; } ? phase_post_substep : 0u) |
                (requires { &Device::settle; } ? phase_settle : 0u) |
                (requires { &Device::sense; } ? phase_sense : 0u);
  kind.describe = [] { return describe_fields<typename Device::Spec>(); };
  kind.create_pool = []() -> std::unique_ptr<PoolBase> { return std::make_unique<DevicePool<Device>>(); };
  return kind;
}

/// The service of that name, or an error with the nearest one. @param device  for the error: its path
Result<const DeviceService*> service_of(const Kind& kind, std::string_view device, std::string_view service);

/// All kinds, in the order of devices/kinds.h.
std::span<const Kind* const> device_kinds();
/// By name, or an error with the nearest one.
Result<const Kind*> find_device_kind(std::string_view name);
/// The kind that answers to a name an SDF file used for this element, or null; a sensor's plugin takes
/// precedence.
const Kind* find_device_kind_for_sdf(const model::DeviceDecl& decl);

}  // namespace sandlot
