#pragma once
/// Specs that devices declared alike share, until one of them is tuned: in a swarm they are the larger part
/// of a device.
///
/// A kind opts in with `SharedSpec<Spec> spec` and create(const DeviceBuild&, SharedSpec<Spec>).
#include <algorithm>
#include <memory>
#include <type_traits>
#include <utility>

#include "base/bytes.h"
#include "base/describe.h"
#include "base/read.h"

namespace sandlot {

template <class Spec>
class SharedSpec {
 public:
  explicit SharedSpec(Spec spec) : spec_(std::make_shared<Spec>(std::move(spec))) {}
  const Spec& operator*() const { return *spec_; }
  const Spec* operator->() const { return spec_.get(); }
  void set(Spec spec) { spec_ = std::make_shared<Spec>(std::move(spec)); }
  bool is_same(const SharedSpec& other) const { return spec_ == other.spec_; }

 private:
  std::shared_ptr<const Spec> spec_;
};

template <class Device>
constexpr bool shares_spec = std::is_same_v<decltype(Device::spec), SharedSpec<typename Device::Spec>>;

template <class Device>
const typename Device::Spec& spec_of(const Device& device) {
  if constexpr (shares_spec<Device>) return *device.spec;
  else return device.spec;
}

/// Gives a device a spec whose tunable fields may differ from its own; where none does, it goes on sharing.
template <class Device>
void set_spec(Device& device, typename Device::Spec spec) {
  if constexpr (shares_spec<Device>) {
    const auto write_all = [](ByteWriter& w, const typename Device::Spec& s) {
      write_tunables(w, s);
      if constexpr (requires { s.errors; }) write(w, s.errors);
    };
    ByteWriter is, was;
    write_all(is, spec);
    write_all(was, *device.spec);
    if (!std::ranges::equal(is.bytes(), was.bytes())) device.spec.set(std::move(spec));
  } else {
    device.spec = std::move(spec);
  }
}

}  // namespace sandlot
