#include "programs/robios/robios.h"

#include <poll.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/log.h"
#include "base/text.h"
#include "programs/robios/compile.h"

namespace sandlot::programs::robios {
namespace {

using namespace sandlot::robios;
using namespace std::chrono_literals;

constexpr std::size_t most_waiting = 256;  ///< radio messages
constexpr std::int64_t most_ns = std::int64_t{1} << 62;
constexpr std::size_t most_logged_lines = 200, most_last_words = 5;
enum Ended : std::uint8_t { by_itself = 1, killed = 2, spun = 3 };

}  // namespace

Status Robios::init(const Description& robot, const Node& config, Outputs& out) {
  SL_ASSIGN(spec_, read_spec<Spec>(config));
  path_ = out.path();
  robot_ = robot;
  if (!robot.members.empty())
    return Error{"a RoBIOS program drives one robot, not a team", "give each robot its own controller"};
  if (spec_.api != 0 && spec_.api != 6 && spec_.api != 7)
    return Error{"api is 6 or 7, not " + std::to_string(spec_.api),
                 "leave it out to go by the program's text",
                 {},
                 "/api"};
  if (spec_.program.empty()) return Error{"the program has no name", "program: wander.c", {}, "/program"};
  return devices_.find(robot, std::exchange(facts_, {}), spec_);
}

void Robios::load(ByteReader& r) {
  OutsideProgram::load(r);
  const auto finite = [](const auto& all) {
    return std::all_of(all.begin(), all.end(), [](double each) { return std::isfinite(each); });
  };
  // What it is trusted for: sizes of the shared memory, and arithmetic of times.
  const bool fits = state_.held.size() <= most_order_bytes && state_.inbox.size() <= most_waiting &&
                    state_.offered <= state_.inbox.size() && state_.now_ns >= 0 && state_.now_ns < most_ns &&
                    state_.until_ns >= 0 && finite(state_.odometry) && finite(state_.origin) &&
                    finite(state_.wheels) &&
                    std::all_of(state_.inbox.begin(), state_.inbox.end(),
                                [](const Received& each) { return each.data.size() <= most_radio_bytes; });
  if (!fits) r.fail();
}

// ------------------------------------------------------------------------------------- what the simulation sees

std::int64_t Robios::slot_ns() const { return Time::from_s(spec_.slot_s).ns; }

void Robios::meet(std::span<const Being> beings) {
  state_.robots.clear();
  for (const Being& each : beings)
    if (each.is_robot) {
      state_.robots.push_back(each.name);
      if (each.name == robot_.robot) state_.number = each.number;
    }
}

/// Keeps what the radio has received since the step before.
void Robios::take_messages(const Observation& obs) {
  const auto* const topic = devices_.receptions(obs);
  if (!topic || topic->count == state_.receptions) return;
  state_.receptions = topic->count;
  for (const msg::RadioReception& each : topic->message.packets) {
    const auto sender = std::find(state_.robots.begin(), state_.robots.end(), each.from);
    const std::uint32_t from = sender == state_.robots.end()
                                   ? 0
                                   : static_cast<std::uint32_t>(sender - state_.robots.begin()) + 1;
    if (state_.inbox.size() >= most_waiting || each.data.size() > most_radio_bytes) ++state_.dropped;
    else state_.inbox.push_back({from, each.data});
  }
}

bool Robios::is_due(const Observation& obs) const {
  // The slot in which the time lies that it waits for.
  if (obs.now().ns >= state_.until_ns / slot_ns() * slot_ns()) return true;
  if ((state_.events & wake_key) != 0 && devices_.key_presses(obs) != state_.keys) return true;
  if ((state_.events & wake_radio) != 0 && !state_.inbox.empty()) return true;
  if ((state_.events & wake_drive_done) != 0 && devices_.maneuver_done(obs)) return true;
  return (state_.events & wake_picture) != 0 && devices_.pictures(obs) != state_.pictures;
}

/// From when on orders of the latest turn act: in the tick in which its slot ends.
std::int64_t Robios::acting_ns() const {
  return state_.now_ns / slot_ns() * slot_ns() + slot_ns() - tick_.ns;
}

/// The next look at whether it is due: each control step if messages may come, else slots; or when orders that are held act.
Program::Resumed Robios::wait_on() const {
  if (!state_.held.empty())
    return {.waiting_for = Waiting::time,
            .until = devices_.has_radio() ? Time{} : Time::from_ns(acting_ns())};
  if (state_.ended != 0) return {.waiting_for = Waiting::nothing};
  const std::int64_t slot = slot_ns(), next = state_.now_ns / slot * slot + slot;
  if (devices_.has_radio()) return {.waiting_for = Waiting::control_step};
  const std::int64_t wanted = state_.events == 0 ? state_.until_ns / slot * slot : 0;
  return {.waiting_for = Waiting::time, .until = Time::from_ns(std::max(next, wanted))};
}

Program::Resumed Robios::resume(const Observation& obs, Command& cmd) {
  if (!state_.held.empty() && obs.now().ns >= acting_ns()) carry_out(std::exchange(state_.held, {}), cmd);
  if (state_.ended != 0) return wait_on();
  take_messages(obs);
  if (state_.running == 0) {
    const std::int64_t slot = slot_ns(), now = obs.now().ns;
    const bool begins = state_.turns == 0 || now / slot != state_.now_ns / slot;
    if (!begins) return wait_on();
    if (state_.turns > 0 && !is_due(obs)) {
      Resumed next = wait_on();
      next.until = std::max(next.until, Time::from_ns(now / slot * slot + slot));
      return next;
    }
    state_.running = 1;
    ++state_.turns;
    state_.now_ns = now;
    state_.odometry = devices_.odometry(obs);
    state_.keys = devices_.key_presses(obs);
    state_.pictures = devices_.pictures(obs);
    state_.offered = static_cast<std::uint32_t>(std::min(state_.inbox.size(), most_radio_messages));
  }
  if (child_) give_turn(obs);
  return {.waiting_for = Waiting::outside};
}

Program::Resumed Robios::answer(const OutsideAnswer& answer, std::span<const TopicBase* const>,
                                Command& cmd) {
  if (state_.ended != 0) return wait_on();
  if (answer.kind == OutsideAnswer::Kind::gone) return ended(killed, cmd);
  if (answer.kind == OutsideAnswer::Kind::missed) {
    if (child_)
      log::warning("program '" + path_ + "' has used more than " + number_text(spec_.deadline_s) +
                   " s of real time in one time slot: it spins, and is ended");
    return ended(spun, cmd);
  }
  state_.running = 0;
  state_.inbox.erase(
      state_.inbox.begin(),
      state_.inbox.begin() + std::min<std::ptrdiff_t>(state_.offered, std::ssize(state_.inbox)));
  state_.offered = state_.dropped = 0;
  const Orders read = read_orders(answer.bytes);
  if (acting_ns() <= state_.now_ns) carry_out(answer.bytes, cmd);
  else if (!read.orders.empty() || read.refused > 0) state_.held = answer.bytes;
  for (const Order& order : read.orders)
    if (const auto* const note = std::get_if<Note>(&order); note && child_)
      log::info(path_ + ": " + note->text);
  if (read.finished) {
    state_.exit_code = *read.finished;
    return ended(by_itself, cmd);
  }
  // Without a word of when, in the next slot.
  const WaitOrder wait = read.wait.value_or(WaitOrder{});
  state_.until_ns = std::max<std::int64_t>(wait.until_ns, 0);
  state_.events = wait.events & (wake_key | wake_radio | wake_drive_done | wake_picture);
  return wait_on();
}

void Robios::carry_out(std::span<const std::byte> orders, Command& cmd) {
  const Orders read = read_orders(orders);
  std::uint64_t refused = read.refused;
  for (const Order& order : read.orders) {
    const bool may = !std::holds_alternative<EntityPose>(order) || spec_.supervisor;
    if (!may || !devices_.carry_out(order, state_, cmd)) ++refused;
  }
  if (begun_ != Clock::time_point() && refused > 0 && state_.refused == 0)
    log::warning("program '" + path_ + "' gave an order that is not carried out" +
                 (read.why.empty() ? " by this robot" : ": " + read.why) +
                 "; further ones are counted alone");
  state_.refused += refused;
}

/// The program is no more: its robot stands still, and the run goes on.
Program::Resumed Robios::ended(std::uint8_t how, Command& cmd) {
  state_.ended = how;
  state_.running = 0;
  state_.inbox.clear();
  state_.offered = 0;
  if (how != by_itself) {
    state_.held.clear();
    devices_.stop(cmd);
  }
  child_.reset();
  memory_.reset();
  waiting_ = false;
  return wait_on();
}

// --------------------------------------------------------------------------------------------------- the process

Status Robios::connect() {
  SL_ASSIGN(ProgramLaunch program,
            prepare({spec_.program, spec_.folder, spec_.api, spec_.flags, spec_.output, spec_.budget}));
  SL_ASSIGN(memory_, SharedMemory::make());
  devices_.describe(spec_, state_, memory_->memory().robot);
  program.inherited.push_back(memory_->descriptor());
  program.environment.push_back(std::string(descriptor_variable) + "=" +
                                std::to_string(memory_->descriptor()));
  SL_ASSIGN(Launch launch, launch_of(program));
  launch.limits->niceness = 0;  // the run waits for it
  SL_ASSIGN(child_, Child::start(launch));
  waiting_ = halted_ = answered_ = false;
  begins_anew_ = state_.turns > 0 && state_.running == 0;
  deadline_ = Clock::now() + 1s;
  sent_pictures_ = 0;
  begun_ = measured_ = Clock::now();
  last_words_.clear();
  return {};
}

void Robios::adopt(Outside& before) {
  Robios& old = static_cast<Robios&>(before);
  memory_ = std::exchange(old.memory_, std::nullopt);
  child_ = std::exchange(old.child_, std::nullopt);
  waiting_ = old.waiting_;
  halted_ = old.halted_;
  answered_ = old.answered_;
  begins_anew_ = old.begins_anew_;
  deadline_ = old.deadline_;
  begun_ = old.begun_;
  measured_ = old.measured_;
  last_words_ = std::move(old.last_words_);
  output_ = std::move(old.output_);
  sent_pictures_ = 0;  // the camera may be another one
}

Result<bool> Robios::keep_output(const std::string& folder) {
  if (!child_) return false;
  SL_TRY(output_.open(folder, path_));
  return true;
}

void Robios::watched(std::vector<Watched>& out) const {
  if (!child_) return;
  if (child_->output() >= 0) out.push_back({child_->output(), false});
  if (child_->error() >= 0) out.push_back({child_->error(), false});
}

/// Writes what the robot senses, for a turn.
void Robios::fill(const Observation& obs) {
  Senses& senses = memory_->memory().senses;
  senses.now_ns = state_.now_ns;
  senses.slot_end_ns = state_.now_ns / slot_ns() * slot_ns() + slot_ns();
  senses.wall_ns = std::chrono::nanoseconds(Clock::now() - begun_).count();
  devices_.sense(obs, state_, senses, sent_pictures_);
  senses.radio_messages = state_.offered;
  senses.radio_dropped = state_.dropped;
  for (std::uint32_t i = 0; i < state_.offered; ++i) {
    const Received& from = state_.inbox[i];
    RadioMessage& to = senses.radio[i];
    to.from = from.from;
    to.size = static_cast<std::uint32_t>(from.data.size());
    if (!from.data.empty()) std::memcpy(to.bytes, from.data.data(), from.data.size());
  }
  senses.peers = 0;
  for (std::uint32_t number = 1; number <= state_.robots.size() && senses.peers < most_peers; ++number)
    if (number != state_.number) senses.peer[senses.peers++] = number;
  senses.entities = 0;
  if (!spec_.supervisor) return;
  for (const Being& each : beings_) {
    if (senses.entities == most_entities) return;
    const Vec3& p = each.X_WM.p;
    senses.entity[senses.entities++] = {each.number, each.is_robot ? 1u : 0u, p.x, p.y,
                                        p.z,         yaw_of(each.X_WM.q)};
  }
}

void Robios::give_turn(const Observation& obs) {
  fill(obs);
  lines_ = 0;
  slice_ = 1ms;
  waiting_ = true;
  deadline_ = Clock::now() +
              std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(spec_.deadline_s));
  memory_->give_turn();
  if (std::exchange(halted_, false)) halt(child_->process(), false);
}

/// In slices: a program that writes much, and one that has died, must be noticed.
bool Robios::await(Clock::time_point until) {
  if (!child_ || !memory_) return false;
  memory_->await_turn(std::min(until, Clock::now() + slice_));
  slice_ = std::min<std::chrono::microseconds>(slice_ * 2, 16ms);
  return true;
}

void Robios::move_output() {
  const std::size_t before = lines_;
  child_->move();
  const auto take = [&](std::string& line, bool is_error) {
    output_.write(line);
    if (++lines_ == most_logged_lines + 1) log::warning(path_ + ": more than 200 lines in one time slot");
    if (lines_ <= most_logged_lines) (is_error ? log::warning : log::info)(path_ + ": " + line);
    if (line.empty()) return;
    if (last_words_.size() == most_last_words) last_words_.erase(last_words_.begin());
    last_words_.push_back(std::move(line));
  };
  while (auto line = child_->take_line()) take(*line, false);
  while (auto note = child_->take_note()) take(*note, true);
  if (lines_ != before) slice_ = 1ms;
}

/// The answer of a process that has gone, or has to go.
OutsideAnswer Robios::leave(std::string why) {
  if (!last_words_.empty()) {
    why += "; its last words:";
    for (const std::string& each : last_words_) why += "\n  " + each;
  }
  child_.reset();
  memory_.reset();
  waiting_ = false;
  return OutsideAnswer::of(OutsideAnswer::Kind::gone, why);
}

/// What the processes of the program use, twice a second. Those that use more of the processor than they may are halted
/// until the program's next turn.
std::optional<std::string> Robios::over_budget() {
  const auto now = Clock::now();
  const double passed_s = std::chrono::duration<double>(now - measured_).count();
  if (passed_s < 0.5) return std::nullopt;
  measured_ = now;
  const ProcessMeter::Usage usage = meter_.sample(child_->process());
  if (static_cast<double>(usage.memory_bytes) > spec_.budget.memory_bytes)
    return "it used more memory than its " + number_text(spec_.budget.memory_bytes / 1e6) + " MB";
  if (!waiting_ && usage.cpu_s > spec_.budget.cpu * passed_s && !halted_) {
    halted_ = true;
    halt(child_->process(), true);
  }
  return std::nullopt;
}

/// Moves of a supervisor and gains of the drive's loops, which are requests of their own.
void Robios::request_changes(std::span<const std::byte> orders) {
  moves_.clear();
  settings_.clear();
  const Orders read = read_orders(orders);
  for (const Order& order : read.orders)
    if (const auto* const control = std::get_if<ControlOrder>(&order); control && control->on != 0)
      devices_.add_gains(*control, settings_);
  if (!spec_.supervisor) return;
  for (const Order& order : read.orders)
    if (const auto* const wanted = std::get_if<EntityPose>(&order))
      for (const Being& each : beings_)
        if (each.number == wanted->id && each.is_robot == (wanted->is_robot != 0))
          moves_.push_back(
              {each.name, {{wanted->x_m, wanted->y_m, wanted->z_m}, quat_from_rpy(0, 0, wanted->phi_rad)}});
}

std::optional<OutsideAnswer> Robios::receive() {
  if (!child_) return std::nullopt;
  // Its first turn shall be the next slot: what the process before waited for is over. As an answer without orders.
  if (std::exchange(begins_anew_, false) && !waiting_) return OutsideAnswer{OutsideAnswer::Kind::message, {}};
  if (!memory_->has_turn()) {
    move_output();
    if (memory_->has_turn()) return receive();
    if (auto why = over_budget()) return leave(std::move(*why));
    const auto status = child_->exit_status();
    if (!status) return std::nullopt;
    if (memory_->has_turn()) return receive();  // its last words came in between
    move_output();
    std::string why = text_of_exit(*status);
    // Variables of a program that do not fit make the kernel kill it before its first instruction.
    if (!answered_ && last_words_.empty() && (WIFSIGNALED(*status) || WEXITSTATUS(*status) > 128))
      why += " before its first call of RoBIOS: its variables may take more than the " +
             number_text(spec_.budget.memory_bytes / 1e6) + " MB that it may use; memory: 2 GB allows more";
    return leave(std::move(why));
  }
  waiting_ = false;
  answered_ = true;
  OutsideAnswer out{OutsideAnswer::Kind::message, memory_->orders()};
  request_changes(out.bytes);
  move_output();
  if (const Orders read = read_orders(out.bytes); read.finished) {
    // What it still has to say; it may be cleaning up.
    const auto end = Clock::now() + 300ms;
    while (!child_->exit_status() && Clock::now() < end) {
      pollfd either[2] = {{child_->output(), POLLIN, 0}, {child_->error(), POLLIN, 0}};
      poll(either, 2, 2);
      move_output();
    }
    move_output();
    std::string how = "program '" + path_ + "' ended with code " + std::to_string(*read.finished);
    if (*read.finished != 0 && !last_words_.empty()) {
      how += "; its last words:";
      for (const std::string& each : last_words_) how += "\n  " + each;
    }
    (*read.finished == 0 ? log::info : log::warning)(how);
  } else if (auto why = over_budget()) {
    return leave(std::move(*why));
  }
  return out;
}

extern const ProgramKind kind;
constinit const ProgramKind kind{
    .name = "robios",
    .help = "A program of EyeBot and EyeSim in C or C++, unchanged, in a process of its own.",
    .describe = [] { return describe_fields<Spec>(); },
    .create = []() -> std::unique_ptr<Program> { return std::make_unique<Robios>(); },
};

}  // namespace sandlot::programs::robios
