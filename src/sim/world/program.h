#pragma once
/// Program: anything that decides for a robot, such as a controller in this process. It is resumed once per control
/// interval and returns what it waits for.
#include <memory>
#include <optional>
#include <string>

#include "control/controller.h"

namespace sandlot {

class Program {
 public:
  enum class Waiting { control_step, nothing };  ///< `nothing`: it has ended
  struct Resumed {
    Waiting waiting_for = Waiting::control_step;
    Time local_time;                          ///< how far the program has come in its own time
    std::optional<std::string> failure = {};  ///< why it cannot go on; ends the run
  };
  virtual ~Program() = default;
  /// Lets the program run until `until`. Called in parallel with other programs.
  virtual Resumed resume(Time until, const Observation& obs, Command& cmd) = 0;
  virtual Status set_parameter(std::string_view path, const Node& value) = 0;
  /// A number of its parameters or state by its path, and all of them; none when it keeps them to itself.
  virtual ValueFound value(ValuePart, std::span<const ValueStep>) const { return {}; }
  virtual void list_values(ValuePart, const ValueVisit&) const {}
  virtual void save(ByteWriter& w) const = 0;
  virtual void load(ByteReader& r) = 0;
};

/// A controller as a program: one step per resume.
class ControllerProgram final : public Program {
 public:
  explicit ControllerProgram(std::unique_ptr<Controller> controller) : controller_(std::move(controller)) {}
  Controller& controller() { return *controller_; }
  Resumed resume(Time until, const Observation& obs, Command& cmd) override {
    return {Waiting::control_step, until, caught([&] { controller_->step(obs, cmd); })};
  }
  Status set_parameter(std::string_view path, const Node& value) override {
    return controller_->set_parameter(path, value);
  }
  ValueFound value(ValuePart part, std::span<const ValueStep> path) const override {
    return controller_->value(part, path);
  }
  void list_values(ValuePart part, const ValueVisit& visit) const override {
    controller_->list_values(part, visit);
  }
  void save(ByteWriter& w) const override { controller_->save(w); }
  void load(ByteReader& r) override { controller_->load(r); }

 private:
  std::unique_ptr<Controller> controller_;
};

}  // namespace sandlot
