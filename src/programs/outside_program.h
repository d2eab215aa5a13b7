#pragma once
/// OutsideProgram: keys (Spec) and State of a program outside this process, seen through their field lists as parameters, values
/// and bytes. What ElementAdapter (base/element.h) is for elements: a kind derives from it and writes how it is resumed, how it
/// acts on answers, and its connection, none of which is State.
#include <cstdint>
#include <span>

#include "base/read.h"
#include "base/values.h"
#include "control/program.h"

namespace sandlot::programs {

/// What becomes of a program's process in a run that is restored or rewound.
enum class AfterRestore : std::uint8_t { restart, detach };
inline std::span<const EnumName<AfterRestore>> enum_names(AfterRestore) {
  static constexpr EnumName<AfterRestore> names[] = {{"restart", AfterRestore::restart},
                                                     {"detach", AfterRestore::detach}};
  return names;
}

template <class Spec, class State>
class OutsideProgram : public Program, public Outside {
 public:
  Outside* outside() override { return this; }
  Status set_parameter(std::string_view path, const Node& value) override {
    Spec changed = spec_;
    SL_TRY(set_tunable(changed, path, value));
    spec_ = std::move(changed);
    return {};
  }
  ValueFound value(ValuePart part, std::span<const ValueStep> path) const override {
    return value_at(part, spec_, state_, path);
  }
  void list_values(ValuePart part, const ValueVisit& visit) const override {
    sandlot::list_values(part, spec_, state_, visit);
  }
  void save(ByteWriter& w) const override {
    write_tunables(w, spec_);
    write(w, state_);
  }
  void load(ByteReader& r) override {
    read_tunables(r, spec_);
    read(r, state_);
  }

 protected:
  Spec spec_;
  State state_;
};

}  // namespace sandlot::programs
