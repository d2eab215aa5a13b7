#pragma once
/// Element with keys (Spec) and State, seen through its field lists: a rule, a medium, a marker, a controller.
///
/// A kind's author writes a struct T with `using Spec`, `using State`, the members `Spec spec; State state;` and the functions
/// of its border; ElementAdapter<Border, T> derives parameters, values and bytes from the lists. Border is the abstract class
/// of that sort of element: derived from Element, or, as the border to plugins, with the same functions of its own.
#include <span>
#include <string_view>

#include "base/bytes.h"
#include "base/read.h"
#include "base/values.h"

namespace sandlot {

class Element {
 public:
  virtual ~Element() = default;
  virtual Status set_parameter(std::string_view path, const Node& value) = 0;
  /// A number of the spec or the state by its path, and all of them.
  virtual ValueFound value(ValuePart part, std::span<const ValueStep> path) const = 0;
  virtual void list_values(ValuePart part, const ValueVisit& visit) const = 0;
  /// Tunable fields and State. load() fails the reader on what cannot be.
  virtual void save(ByteWriter& w) const = 0;
  virtual void load(ByteReader& r) = 0;
};

template <class Border, class T>
class ElementAdapter : public Border {
 public:
  Status set_parameter(std::string_view path, const Node& value) override {
    typename T::Spec changed = element_.spec;
    SL_TRY(set_tunable(changed, path, value));
    element_.spec = std::move(changed);
    return {};
  }
  ValueFound value(ValuePart part, std::span<const ValueStep> path) const override {
    return value_at(part, element_.spec, element_.state, path);
  }
  void list_values(ValuePart part, const ValueVisit& visit) const override {
    sandlot::list_values(part, element_.spec, element_.state, visit);
  }
  void save(ByteWriter& w) const override {
    write_tunables(w, element_.spec);
    write(w, element_.state);
  }
  void load(ByteReader& r) override {
    read_tunables(r, element_.spec);
    read(r, element_.state);
    if constexpr (requires { element_.fits(); })
      if (!element_.fits()) r.fail();
  }

 protected:
  T element_;
};

}  // namespace sandlot
