#pragma once
/// Publisher: the last phase of a tick. It fills an immutable frame with what the observers want and hands it to them.
///
/// Cost   nothing without observers. Recording wants a copy of all messages and a hash of all State at every tick, so both
///        are made as cheap as they can be: memory is reused once nobody holds a frame, and a part of the State that did
///        not change is not hashed again.
#include <memory>
#include <vector>

#include "sim/world/frame.h"

namespace sandlot {

class Simulation;

class Publisher {
 public:
  /// `simulation` must outlive the publisher.
  explicit Publisher(const Simulation& simulation);
  ~Publisher();

  void add(Observer* observer) { observers_.push_back(observer); }
  void remove(Observer* observer) { std::erase(observers_, observer); }
  /// Asks the observers what they want of this tick.
  void begin_tick();
  /// What all observers together want of this tick.
  const Observer::Wants& wants() const { return wants_; }
  void publish();
  /// A frame of the present with its instances, and links and contacts if wanted.
  std::shared_ptr<const Frame> look(const Observer::Wants& wants) const;

 private:
  struct Memory;
  void fill_time(Frame& frame) const;
  void fill_instances(Frame& frame, bool links) const;
  void fill_contacts(Frame& frame) const;
  void fill_topics(Frame& frame);
  void fill_log(Frame& frame);
  void fill_hashes(Frame& frame);

  const Simulation& sim_;
  std::vector<Observer*> observers_;
  Observer::Wants wants_;
  std::unique_ptr<Memory> memory_;  ///< null until the first frame
};

}  // namespace sandlot
