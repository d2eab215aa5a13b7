#pragma once
/// Wrong tokens by the address that they came from. Each address may send `at_once` of them, and one more per `pause_s`; beyond that
/// its tokens are not looked at, right ones included. Reconnecting changes nothing.
///
/// Limits   what shares an address shares its allowance: the programs of one machine, or of one network behind NAT. Addresses of IPv6
///          count by their first 64 bits. Of most_addresses the one that has been silent for longest is forgotten.
/// Cost     a lookup per token.
#include <chrono>
#include <map>
#include <string>

namespace sandlot::server {

class Guesses {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t most_addresses = 10'000;

  Guesses(double at_once, double pause_s) : at_once_(at_once), pause_s_(pause_s) {}
  /// Whether a token of this address may be looked at.
  bool allowed(const std::string& address, Clock::time_point now) const {
    const auto found = wrong_.find(address);
    return found == wrong_.end() || left(found->second, now) >= 1;
  }
  void count_wrong(const std::string& address, Clock::time_point now) {
    if (wrong_.size() >= most_addresses && wrong_.count(address) == 0) forget_one();
    Allowance& of = wrong_.try_emplace(address, Allowance{at_once_, now}).first->second;
    of = {left(of, now) - 1, now};
  }
  std::size_t addresses() const { return wrong_.size(); }

 private:
  struct Allowance {
    double left = 0;
    Clock::time_point since;
  };
  double left(const Allowance& of, Clock::time_point now) const {
    const double passed_s = std::chrono::duration<double>(now - of.since).count();
    const double grown = of.left + passed_s / pause_s_;
    return grown < at_once_ ? grown : at_once_;
  }
  void forget_one() {
    auto oldest = wrong_.begin();
    for (auto i = wrong_.begin(); i != wrong_.end(); ++i)
      if (i->second.since < oldest->second.since) oldest = i;
    wrong_.erase(oldest);
  }
  double at_once_, pause_s_;
  std::map<std::string, Allowance> wrong_;
};

}  // namespace sandlot::server
