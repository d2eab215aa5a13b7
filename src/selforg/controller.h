#pragma once
/// Controller: sensor values in, motor values out, once per control step. All values are numbers, by convention within [-1, 1].
///
///   auto made = selforg::make_controller("sox", {.sensors = 2, .motors = 2});
///   made.value()->step(x, y);          // spans of double
///
/// A kind's author writes a struct with field lists and one function; ControllerOf derives parameters, named values, channels of
/// the log and bytes from the lists:
///
///   struct Mine {
///     struct Spec { ... };  struct State { ... };           // State: Matrix, numbers, lists; sized by init()
///     Spec spec; State state;
///     Status init(const Setup& setup);
///     void step(const Matrix& x, Matrix& y, Mode mode);     // no heap
///     static constexpr std::string_view channels[] = ...;   // optional: State fields that are logged; without it all are
///     Teachable* teachable();  Rewardable* rewardable();    // optional
///   };
///
/// Sensors   a value that is not finite is replaced by the last one that was (0 at first) and counted in `bad_sensors`; values
///           beyond +-1000 are clipped. Zero sensors or motors are allowed.
/// Random    numbers are functions of Setup::seed, Setup::name and the step (base/random.h).
/// Heap      none in a step.
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/describe.h"
#include "base/element.h"
#include "base/random.h"
#include "selforg/matrix.h"

namespace sandlot::selforg {

/// Sizes and random key of a controller or wiring.
struct Setup {
  std::size_t sensors = 0, motors = 0;
  std::uint64_t seed = 0;
  std::string name = "agent";  ///< key of its random numbers

  Stream random(std::uint64_t step, std::uint64_t use = 0) const {
    return Stream(seed, entity_key(name), Purpose::controller, step).fork(use);
  }
};

enum class Mode : std::uint8_t {
  learn,   ///< y is the output; parameters adapt
  act,     ///< y is the output; parameters stay
  babble,  ///< y is given: what somebody else sends to the motors; models and controller learn from it
};

/// Guided self-organisation: controllers that accept desired motor or sensor values, each for one step.
class Teachable {
 public:
  virtual ~Teachable() = default;
  /// Desired values of the motors, clipped to +-0.95. A value that is not finite leaves its motor alone.
  virtual void teach_motors(std::span<const double> y) = 0;
  /// Desired values of the sensors, which the world model translates to motors.
  virtual void teach_sensors(std::span<const double> x) = 0;
  virtual std::span<const double> last_motors() const = 0;
};

/// Controllers that accept a reward, for one step.
class Rewardable {
 public:
  virtual ~Rewardable() = default;
  /// @param reward  clipped to [-1, 1]
  virtual void set_reward(double reward) = 0;
};

/// Named matrix or number of a controller for logs and plots: "A" with 2 x 3 elements, "t" with one.
struct Channel {
  std::string_view name;
  std::size_t rows = 1, cols = 1;
  std::span<const double> values;  ///< column after column; valid during the visit
};
using ChannelVisit = std::function<void(const Channel&)>;
/// "v" of one number, "x[2]" of a vector's, "A[1,2]" of a matrix's.
std::string channel_name(const Channel& channel, std::size_t element);

class Controller : public Element {
 public:
  virtual const char* kind() const = 0;
  virtual std::vector<FieldInfo> describe() const = 0;
  virtual Status init(const Node& parameters, const Setup& setup) = 0;
  std::size_t sensors() const { return setup_.sensors; }
  std::size_t motors() const { return setup_.motors; }
  const Setup& setup() const { return setup_; }

  /// @param x  sensors() values  @param y  motors() values: out, in Mode::babble in
  void step(std::span<const double> x, std::span<double> y, Mode mode = Mode::learn);

  virtual void channels(const ChannelVisit& visit) const = 0;
  virtual Teachable* teachable() { return nullptr; }
  virtual Rewardable* rewardable() { return nullptr; }
  /// Key of the parameters that are fixed after init(): stored controllers fit those with the same.
  virtual std::uint64_t fixed_key() const = 0;
  /// The tunable parameters alone, for another object of the same kind.
  virtual void save_parameters(ByteWriter& w) const = 0;
  virtual void load_parameters(ByteReader& r) = 0;

  /// A tunable parameter by its name: set("epsC", 0.2). Errors: unknown, out of range, fixed.
  Status set(std::string_view parameter, double number);
  Status set(std::string_view parameter, const char* text);
  Result<double> get(std::string_view parameter) const;
  std::uint64_t bad_sensors() const { return input_.bad; }

 protected:
  struct Input {
    Matrix x;
    std::uint64_t bad = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"x", "1", "Sensor values of the last step."}, s.x);
      visit(Field{"bad", "1", "Sensor values so far that were not finite."}, s.bad);
    }
  };
  virtual void step_element(const Matrix& x, Matrix& y, Mode mode) = 0;
  Setup setup_;
  Input input_;
  Matrix output_;
};

/// Whether two objects of a type with a field list have lists and matrices of the same lengths.
template <class T>
bool same_sizes(const T& a, const T& b) {
  if constexpr (is_vector<T>::value) {
    if (a.size() != b.size()) return false;
    if constexpr (Fielded<typename T::value_type>)
      for (std::size_t i = 0; i < a.size(); ++i)
        if (!same_sizes(a[i], b[i])) return false;
    return true;
  } else if constexpr (std::is_same_v<T, Matrix>) {
    return a.rows == b.rows && a.cols == b.cols && a.data.size() == b.data.size();
  } else if constexpr (Fielded<T>) {
    std::vector<const void*> others;
    T::fields(b, [&](const Field&, const auto& member) { others.push_back(&member); });
    std::size_t i = 0;
    bool same = true;
    T::fields(a, [&](const Field&, const auto& member) {
      same = same &&
             same_sizes(member, *static_cast<const std::remove_cvref_t<decltype(member)>*>(others[i]));
      ++i;
    });
    return same;
  } else {
    return true;
  }
}

/// Largest numbers that a State which was reached by steps can hold: elements of lists and matrices are limited to 1e50 (Sox's
/// errors), other numbers are at most sums of their squares. Products of a few such numbers are finite.
inline constexpr double most_element = 1.000001e50, most_number = 1e120;

/// Whether all numbers in an object with a field list are within these bounds; a file may hold any.
template <class T>
bool numbers_in_bounds(const T& x, double most = most_number) {
  if constexpr (std::is_floating_point_v<T>) return x >= -most && x <= most;
  else if constexpr (is_vector<T>::value) {
    if constexpr (Fielded<typename T::value_type> || std::is_floating_point_v<typename T::value_type>)
      for (const auto& each : x)
        if (!numbers_in_bounds(each, std::is_floating_point_v<typename T::value_type> ? most_element : most))
          return false;
    return true;
  } else if constexpr (Fielded<T>) {
    bool fits = true;
    T::fields(x, [&](const Field&, const auto& member) { fits = fits && numbers_in_bounds(member, most); });
    return fits;
  } else {
    return true;
  }
}

/// Calls visit for each matrix and number among the fields of `state`; `only` empty: all.
template <Fielded State>
void visit_channels(const State& state, std::span<const std::string_view> only, const ChannelVisit& visit) {
  State::fields(state, [&](const Field& field, const auto& member) {
    using Member = std::remove_cvref_t<decltype(member)>;
    if (!only.empty() && std::find(only.begin(), only.end(), field.key) == only.end()) return;
    if constexpr (std::is_same_v<Member, Matrix>) {
      visit({field.key, member.rows, member.cols, member.data});
    } else if constexpr (Number<Member>) {
      const double value = static_cast<double>(member);
      visit({field.key, 1, 1, std::span(&value, 1)});
    }
  });
}

/// Bytes of the fields of a spec that are not tunable.
template <Fielded Spec>
void write_fixed(ByteWriter& w, const Spec& spec) {
  Spec::fields(spec, [&](const Field& field, const auto& member) {
    using Member = std::remove_cvref_t<decltype(member)>;
    if (field.flags & Field::tunable) return;
    if constexpr (Fielded<Member>) write_fixed(w, member);
    else write(w, member);
  });
}

/// load() of an element whose State has sizes that init() gave it.
template <class T>
void load_sized(ByteReader& r, T& element) {
  typename T::Spec spec = element.spec;
  typename T::State state = element.state;
  read_tunables(r, spec);
  read(r, state);
  if (!r.ok()) return;
  if (!same_sizes(state, element.state) || !numbers_in_bounds(state)) return r.fail();
  if constexpr (requires { element.fits(state); })
    if (!element.fits(state)) return r.fail();
  element.spec = std::move(spec);
  element.state = std::move(state);
}

struct ControllerKind {
  const char* name;
  const char* help;
  std::unique_ptr<Controller> (*create)() = nullptr;
};

template <class T>
class ControllerOf final : public ElementAdapter<Controller, T> {
 public:
  explicit ControllerOf(const char* kind) : kind_(kind) {}
  T& element() { return this->element_; }
  const T& element() const { return this->element_; }

  const char* kind() const override { return kind_; }
  std::vector<FieldInfo> describe() const override { return describe_fields(this->element_.spec); }
  Status init(const Node& parameters, const Setup& setup) override {
    SL_ASSIGN(this->element_.spec, read_spec<typename T::Spec>(parameters));
    this->setup_ = setup;
    this->input_ = {};
    this->input_.x = Matrix(setup.sensors, 1);
    this->output_ = Matrix(setup.motors, 1);
    return this->element_.init(setup);
  }
  void channels(const ChannelVisit& visit) const override {
    std::span<const std::string_view> only;
    if constexpr (requires { T::channels; }) only = T::channels;
    visit_channels(this->element_.state, only, visit);
  }
  Teachable* teachable() override {
    if constexpr (requires { this->element_.teachable(); }) return this->element_.teachable();
    else return nullptr;
  }
  Rewardable* rewardable() override {
    if constexpr (requires { this->element_.rewardable(); }) return this->element_.rewardable();
    else return nullptr;
  }
  std::uint64_t fixed_key() const override {
    ByteWriter w;
    write_fixed(w, this->element_.spec);
    return hash64(w.bytes());
  }
  void save_parameters(ByteWriter& w) const override { write_tunables(w, this->element_.spec); }
  void load_parameters(ByteReader& r) override { read_tunables(r, this->element_.spec); }
  void save(ByteWriter& w) const override {
    write(w, this->input_);
    ElementAdapter<Controller, T>::save(w);
  }
  void load(ByteReader& r) override {
    auto input = this->input_;
    read(r, input);
    if (!r.ok()) return;
    if (!same_sizes(input, this->input_) || !numbers_in_bounds(input)) return r.fail();
    load_sized(r, this->element_);
    if (r.ok()) this->input_ = std::move(input);
  }

 protected:
  void step_element(const Matrix& x, Matrix& y, Mode mode) override { this->element_.step(x, y, mode); }

 private:
  const char* kind_;
};

/// The kinds of controllers, in alphabetical order.
std::span<const ControllerKind> controller_kinds();
/// @return the controller, initialised; an unknown kind or a wrong parameter is an error
Result<std::unique_ptr<Controller>> make_controller(std::string_view kind, const Setup& setup,
                                                    const Node& parameters = {});

}  // namespace sandlot::selforg
