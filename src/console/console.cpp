#include "console/console.h"

#include <algorithm>
#include <fstream>
#include <utility>

#include "base/line_comment.h"
#include "base/text.h"
#include "base/units.h"
#include "console/command.h"
#include "console/line_parsing.h"
#include "messages/json.h"
#include "sim/session/run_hooks.h"

namespace sandlot {

using console::BuiltinCommand;
using console::CommandCall;
using console::Word;

/// Answers of scheduled lines come with the outcome of a tick, and the console may be gone by then.
struct Console::ScheduledAnswers {
  std::vector<std::string> answers;
  std::optional<Error> failure;
};

namespace {

Error unknown_command(const std::string& word, const Console::Options& options) {
  return {"there is no command '" + word.substr(0, 60) + "'",
          suggestion(word, console::command_names(options))};
}

const HookCommand* own_command(const Console::Options& options, std::string_view name) {
  if (!options.experiment) return nullptr;
  for (const HookCommand& own : options.experiment->commands())
    if (own.name == name) return &own;
  return nullptr;
}

/// The words of a line, its name first, by the rules of the command that it names.
Result<std::vector<Word>> words_for(std::string_view line) {
  std::vector<Word> plain = console::plain_words_of(line);
  if (plain.empty()) return plain;
  const BuiltinCommand* const command = console::find_command(plain.front().text);
  if (command && command->plain) return plain;
  return console::words_of(line);
}

/// Executes a line, or rehearses it. @return nothing: the answer comes later
console::CommandResult act(CommandCall& call, const BuiltinCommand& command, std::vector<Word> words) {
  std::vector<std::string> texts;
  for (Word& word : words) {
    if (!command.plain && word.text == "--json") {
      call.json = true;
      continue;
    }
    texts.push_back(std::move(word.text));
    call.ends.push_back(word.end);
  }
  texts.erase(texts.begin());
  call.ends.erase(call.ends.begin());
  if (texts.size() < command.min_words)
    return Error{"'" + std::string(command.name) + "' needs more words",
                 std::string(command.name) + " " + command.usage};
  if (texts.size() > 0 && !*command.usage)
    return Error{"'" + std::string(command.name) + "' stands alone",
                 "leave '" + texts.front().substr(0, 60) + "' out"};
  call.words = texts;
  return command.act(call);
}

}  // namespace

std::string_view console::CommandCall::rest(std::size_t count) const {
  if (count == 0 || count > ends.size()) return {};
  return trim(line.substr(ends[count - 1]));
}

Console::Console(Session& session, Options options)
    : session_(session),
      options_(std::move(options)),
      epoch_(session.epoch()),
      answers_(std::make_shared<ScheduledAnswers>()) {}

void Console::execute(std::string_view line, const Caller& caller, const Reply& reply) {
  execute(line, caller, reply, false);
}

void Console::execute(std::string_view line, const Caller& caller, const Reply& reply, bool before_tick) {
  const auto answer = [&](bool ok, std::string text) {
    if (reply) reply({ok, std::move(text)});
  };
  if (line.size() > console::most_letters)
    return answer(false, "a line has " + std::to_string(console::most_letters) + " letters at most");
  if (std::any_of(line.begin(), line.end(),
                  [](unsigned char c) { return (c < ' ' && c != '\t') || c == 127; }))
    return answer(false, "a line is text without control characters");
  auto words = words_for(line);
  if (!words) return answer(false, words.error().text());
  if (words->empty() || words->front().text.empty()) return answer(true, "");
  const std::string name = words->front().text;
  const BuiltinCommand* const command = console::find_command(name);
  if (!command) {
    if (!own_command(options_, name)) return answer(false, unknown_command(name, options_).text());
    if (!caller.may_steer) return answer(false, "'" + name + "' is for those who may steer; you may watch");
    // On its way to where it was before, the run repeats the lines of that time.
    if (const std::string why = session_.report().takes_no_input; !why.empty()) return answer(false, why);
    auto done = options_.experiment->execute(line);
    return done ? answer(true, std::move(*done)) : answer(false, done.error().text());
  }
  if (command->steers && !caller.may_steer)
    return answer(false, "'" + name + "' changes the run; you may watch, not steer");
  CommandCall call{session_, options_, caller, reply, {}, line};
  call.before_tick = before_tick;
  call.schedule = [&](std::string_view later) -> Result<Time> {
    constexpr std::size_t most_waiting = 10'000;
    if (scheduled_.size() - next_ >= most_waiting)
      return Error{std::to_string(most_waiting) + " lines are waiting already"};
    SL_ASSIGN(Scheduled scheduled, read_scheduled(later, {}));
    scheduled.of_run = false;
    const Time at = scheduled.at;
    insert(std::move(scheduled));
    return at;
  };
  auto result = act(call, *command, std::move(*words));
  if (!result) return answer(false, result.error().text());
  if (*result) answer(true, std::move(**result));
}

Status Console::rehearse(std::string_view line) {
  if (line.size() > console::most_letters)
    return Error{"a line has " + std::to_string(console::most_letters) + " letters at most"};
  SL_ASSIGN(std::vector<Word> words, words_for(line));
  if (words.empty()) return Error{"the line is empty"};
  const std::string name = words.front().text;
  const BuiltinCommand* const command = console::find_command(name);
  if (!command) {
    if (own_command(options_, name)) return {};
    return unknown_command(name, options_);
  }
  if (!command->submits) {
    if (words.size() <= command->min_words)
      return Error{"'" + name + "' needs more words", name + " " + command->usage};
    return {};
  }
  const Caller caller;
  const Reply nobody;
  CommandCall call{session_, options_, caller, nobody, {}, line};
  call.rehearsal = true;
  const auto result = act(call, *command, std::move(words));
  // What is not there yet may be there when the time comes.
  if (!result && !call.unknown_thing) return result.error();
  return {};
}

Result<Console::Scheduled> Console::read_scheduled(std::string_view line, const Place& place) {
  Scheduled scheduled{session_.simulation().now(), std::string(trim(line)), place};
  const std::vector<Word> words = console::plain_words_of(line);
  if (!words.empty() && words.front().text == "at") {
    // The time is one word or two: "2s", "2 s".
    std::size_t taken = 2;
    auto at_s = parse_quantity(words.size() > 1 ? words[1].text : "", "s");
    if (words.size() > 2)
      if (auto longer = parse_quantity(words[1].text + " " + words[2].text, "s"))
        at_s = std::move(longer), taken = 3;
    if (!at_s || !(*at_s >= 0 && *at_s <= 9e9) || words.size() <= taken)
      return Error{"'" + std::string(line.substr(0, 200)) + "' is not of the form at TIME COMMAND",
                   "for example: at 2s set rover/laser.noise.white 2 cm"};
    scheduled.at = Time::from_s(*at_s);
    scheduled.text = std::string(trim(line.substr(words[taken - 1].end)));
  }
  SL_TRY(rehearse(scheduled.text));
  return scheduled;
}

void Console::insert(Scheduled scheduled) {
  // Behind those of the same time, and behind what has been executed.
  const auto later = std::upper_bound(scheduled_.begin() + static_cast<std::ptrdiff_t>(next_),
                                      scheduled_.end(), scheduled.at,
                                      [](Time at, const Scheduled& other) { return at < other.at; });
  scheduled_.insert(later, std::move(scheduled));
}

Status Console::schedule(std::string_view line, const Place& place) {
  auto scheduled = read_scheduled(line, place);
  if (!scheduled) {
    Error& error = scheduled.error();
    if (!error.place.file && error.place.line == 0) error.place = place;
    return std::move(error);
  }
  insert(std::move(*scheduled));
  return {};
}

Status Console::schedule_script(const std::string& file) {
  constexpr std::size_t most_lines = 100'000;
  std::ifstream in(file, std::ios::binary);
  if (!in) return Error{"cannot read the script '" + file + "'"};
  Place place{std::make_shared<const std::string>(file), 0, 0};
  std::string line;
  while (std::getline(in, line)) {
    if (static_cast<std::size_t>(++place.line) > most_lines)
      return Error{"a script has " + std::to_string(most_lines) + " lines at most", "", place};
    const std::string_view text = trim(without_comment(line));
    if (!text.empty()) SL_TRY(schedule(text, place));
  }
  if (in.bad() || (!in.eof() && in.fail())) return Error{"cannot read the script '" + file + "'"};
  return {};
}

/// After a change of time: what would not have been executed yet had the run come to here by itself.
void Console::find_next() {
  const Simulation& simulation = session_.simulation();
  const Time before = simulation.now() - simulation.setup().step;
  std::erase_if(scheduled_, [](const Scheduled& line) { return line.over; });
  // Lines for a time that was over when they came lie where they were due, not in order.
  std::stable_sort(scheduled_.begin(), scheduled_.end(),
                   [](const Scheduled& a, const Scheduled& b) { return a.at < b.at; });
  next_ = 0;
  // All that is due by then is executed where the run begins, which may be later than 0.
  if (simulation.now() <= session_.report().begin) return;
  while (next_ < scheduled_.size() && scheduled_[next_].at <= before) ++next_;
}

Status Console::before_tick() {
  SL_TRY(finish());
  if (scheduled_.empty()) return {};
  if (epoch_ != session_.epoch()) {
    // On its way to where it was before, the run takes the input of that time from its own log.
    if (!session_.report().takes_no_input.empty()) return {};
    epoch_ = session_.epoch();
    find_next();
  }
  while (next_ < scheduled_.size() && scheduled_[next_].at <= session_.simulation().now()) {
    Scheduled& due = scheduled_[next_++];
    if (due.over) continue;
    const std::vector<Word> words = console::plain_words_of(due.text);
    const BuiltinCommand* const command = words.empty() ? nullptr : console::find_command(words.front().text);
    due.over = !due.of_run || (command && command->travels && words.size() <= command->stays_with);
    const Scheduled line = due;
    const std::string when = "at " + console::readable(session_.simulation().now().s()) + " s: ";
    const auto take = [answers = answers_, when, line](const Answer& answer) {
      if (answer.ok || !line.of_run)
        answers->answers.push_back(when + (answer.ok ? "" : "error: ") + answer.text);
      else if (!answers->failure) answers->failure = Error{when + answer.text, "", line.place};
    };
    execute(line.text, {}, take, true);
    SL_TRY(finish());
  }
  return {};
}

Status Console::finish() {
  if (!answers_->failure) return {};
  Error error = std::move(*answers_->failure);
  answers_->failure.reset();
  return error;
}

std::vector<std::string> Console::take_answers() { return std::exchange(answers_->answers, {}); }

namespace console {

CommandResult submit(CommandCall& call, std::vector<PendingRequest> requests) {
  SL_CHECK(!requests.empty());
  if (call.rehearsal) return std::optional<std::string>();
  struct Waiting {
    Session& session;
    Console::Reply reply;
    std::size_t left = 0;
    std::vector<std::string> done, refused;
  };
  const Session::Report report = call.session.report();
  const bool stands = !call.before_tick && report.state != Session::State::playing &&
                      report.state != Session::State::seeking;
  auto waiting = std::make_shared<Waiting>(
      Waiting{call.session, stands ? Console::Reply() : call.reply, requests.size()});
  std::string with_next;
  std::size_t submitted = 0;
  constexpr std::size_t most_lines = 20;
  const auto joined = [](const std::vector<std::string>& lines) {
    std::string text;
    for (std::size_t i = 0; i < lines.size() && i < most_lines; ++i) text += (i ? "\n" : "") + lines[i];
    if (lines.size() > most_lines) text += "\n... and " + std::to_string(lines.size() - most_lines) + " more";
    return text;
  };
  std::vector<std::string> later;
  for (PendingRequest& each : requests) {
    const auto finish = [waiting, joined](const Status& status, const std::string& text) {
      if (status) waiting->done.push_back(text);
      else waiting->refused.push_back(status.error().text());
      if (--waiting->left > 0 || !waiting->reply) return;
      if (waiting->refused.empty()) return waiting->reply({true, joined(waiting->done)});
      std::string failed = joined(waiting->refused);
      if (!waiting->done.empty()) failed += "\ndone all the same:\n" + joined(waiting->done);
      waiting->reply({false, failed});
    };
    later.push_back(each.text + " with the next tick");
    const auto done = [waiting, finish, text = each.text](const Status& status) {
      finish(status, text + " from tick " + std::to_string(waiting->session.simulation().tick_index()));
    };
    const auto answered = [finish, done, text = each.text,
                           info = each.response](const Result<std::vector<std::byte>>& response) {
      if (!info) return done(response ? Status() : Status(response.error()));
      std::string json;
      const Status status = response ? cdr_to_json(*info, *response, json) : Status(response.error());
      finish(status, text + ": " + json);
    };
    auto* const asked = std::get_if<CallRequest>(&each.request);
    auto sequence = asked ? call.session.call(std::move(*asked), call.caller.source, answered)
                          : call.session.submit(std::move(each.request), call.caller.source, done);
    if (!sequence) {
      if (submitted == 0) return std::move(sequence.error());
      waiting->left -= 1;  // the run stopped taking input in between: the answer names what was taken
      waiting->refused.push_back(sequence.error().text());
      continue;
    }
    ++submitted;
  }
  if (stands) return std::optional(joined(later));
  return std::optional<std::string>();
}

}  // namespace console
}  // namespace sandlot
