#include "tasks.h"

#include <dlfcn.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "machine.h"

namespace robios {
namespace {

constexpr std::size_t least_stack = 64u << 10, most_stack = 64u << 20, signal_stack = 64u << 10;
constexpr int most_tasks = 256;

std::vector<std::unique_ptr<Task>>& all() {
  static auto* const list = new std::vector<std::unique_ptr<Task>>;  // lives longer than other statics
  return *list;
}
std::uint64_t last_order = 0;
int last_number = 0;
bool events_came = false;
pthread_key_t key;
thread_local Task* own = nullptr;

void become_ready(Task& task) { task.order = ++last_order; }

void wake(Task& task) {
  task.waiting = false;
  task.object = nullptr;
  become_ready(task);
}

bool may_switch() { return tasks.mode == Mode::preempt && !tasks.forbidden; }

/// Tasks become ready whose time or event has come, the earliest first.
void wake_due() {
  const bool look = std::exchange(events_came, false);
  std::vector<Task*> due;
  for (const auto& task : all()) {
    if (!task->waiting) continue;
    if (task->wake_ns <= machine.clock_ns || (look && task->condition && (*task->condition)()))
      due.push_back(task.get());
  }
  std::stable_sort(due.begin(), due.end(), [](Task* a, Task* b) { return a->wake_ns < b->wake_ns; });
  for (Task* const task : due) wake(*task);
}

bool can_run_later(const Task& task) {
  return task.started && !task.suspended && !task.ended && !task.timer && !task.background &&
         (!task.waiting || task.wake_ns < never || task.events != 0);
}

Task* pick() {
  Task* timer = nullptr;
  Task* best = nullptr;
  bool others = false;
  for (const auto& task : all()) {
    others = others || can_run_later(*task);
    if (task->timer && task->can_run() && (!timer || task->order < timer->order)) timer = task.get();
  }
  if (timer) return timer;
  if (!may_switch() && tasks.holder && !tasks.holder->suspended && !tasks.holder->ended)
    return tasks.holder->can_run() ? tasks.holder : nullptr;
  for (const auto& task : all()) {
    if (!task->can_run() || (task->background && others)) continue;
    if (!best || task->priority > best->priority ||
        (task->priority == best->priority && task->order < best->order))
      best = task.get();
  }
  return best;
}

/// Nothing can run now: the clock goes to the next thing that can happen.
void idle() {
  std::int64_t until = never;
  std::uint32_t events = 0;
  for (const auto& task : all()) {
    if (!task->waiting || task->ended) continue;
    until = std::min(until, task->wake_ns);
    events |= task->events;
  }
  if (until == never && events == 0)
    note_once("deadlock", "all tasks of the program wait for each other: nothing will happen any more");
  if (until < machine.slot_end()) {
    machine.clock_ns = std::max(machine.clock_ns, until);
  } else {
    hand_over(until, events);
  }
}

void await_baton(Task& self) {
  while (self.baton.exchange(0, std::memory_order_acquire) == 0) {
    syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&self.baton), FUTEX_WAIT_PRIVATE, 0, nullptr, nullptr,
            0);
  }
}

void pass_baton(Task& next) {
  tasks.current = &next;
  next.baton.store(1, std::memory_order_release);
  syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&next.baton), FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr,
          0);
}

void switch_to(Task& next) {
  Task& self = *tasks.current;
  if (!next.timer && tasks.holder != &next) {
    tasks.holder = &next;
    tasks.slice_start_ns = machine.work_ns;
  }
  if (&next == &self) return;
  const bool goes = self.ended;  // the next one may already forget it
  pass_baton(next);
  if (goes) return;
  await_baton(self);
  if (self.killed) pthread_exit(PTHREAD_CANCELED);
}

void run_others() {
  leave_if_finished();
  for (;;) {
    wake_due();
    if (Task* const next = pick()) return switch_to(*next);
    idle();
  }
}

/// Stack for the signal of a stack that is full.
void use_signal_stack() {
  stack_t stack{};
  stack.ss_size = signal_stack;
  stack.ss_sp = mmap(nullptr, signal_stack, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (stack.ss_sp != MAP_FAILED) sigaltstack(&stack, nullptr);
}
void leave_signal_stack() {
  stack_t none{}, stack{};
  none.ss_flags = SS_DISABLE;
  if (sigaltstack(&none, &stack) == 0 && !(stack.ss_flags & SS_DISABLE)) munmap(stack.ss_sp, stack.ss_size);
}

/// Last thing that a thread does, after its cleanup handlers.
void end_task(void* argument) {
  Task& self = *static_cast<Task*>(argument);
  if (tasks.current != &self) return;
  leave_signal_stack();
  self.ended = true;
  self.waiting = false;
  grant_all(&self);
  if (tasks.holder == &self) tasks.holder = nullptr;
  if (self.killer) {
    Task& killer = *self.killer;
    pass_baton(killer);
    return;
  }
  if (live_tasks() == 0) exit(0);
  const bool forgotten = self.detached && !self.is_own;
  if (forgotten) {
    // It stays in the list until it has chosen the next one.
    for (;;) {
      wake_due();
      if (Task* const next = pick()) {
        if (!next->timer && tasks.holder != next) {
          tasks.holder = next;
          tasks.slice_start_ns = machine.work_ns;
        }
        forget(self);
        pass_baton(*next);
        return;
      }
      idle();
    }
  }
  run_others();
}

void* run_thread(void* argument) {
  Task& self = *static_cast<Task*>(argument);
  own = &self;
  use_signal_stack();
  await_baton(self);
  pthread_setspecific(key, &self);
  if (self.killed) return PTHREAD_CANCELED;
  return self.code();
}

using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);

}  // namespace

Tasks tasks;

void begin_tasks() {
  use_signal_stack();
  pthread_key_create(&key, end_task);
  auto task = std::make_unique<Task>();
  task->name = "main";
  task->started = true;
  task->thread = pthread_self();
  task->priority = 4;
  own = tasks.main = tasks.current = tasks.holder = task.get();
  pthread_setspecific(key, own);
  all().push_back(std::move(task));
}

void main_returns() {
  if (tasks.current != tasks.main || !tasks.begun || tasks.main_waited) return;
  tasks.main->background = true;
  tasks.forbidden = false;
  give_way();
}

void check_thread() {
  if (own != tasks.current)
    quit("a thread that the RoBIOS library did not start called one of its functions");
}

void let_others_run() {
  if (all().size() < 2) return;
  Task& self = *tasks.current;
  if (self.timer || self.killed) return;
  wake_due();
  if (may_switch() && machine.work_ns - tasks.slice_start_ns >= slice_ns) {
    become_ready(self);
    tasks.slice_start_ns = machine.work_ns;
  }
  if (Task* const next = pick()) switch_to(*next);
}

void give_way() {
  Task& self = *tasks.current;
  if (self.timer || self.killed) return;
  become_ready(self);
  tasks.holder = nullptr;
  run_others();
}

bool wait_for(std::int64_t until_ns, std::uint32_t events, const std::function<bool()>& condition,
              Others others) {
  Task& self = *tasks.current;
  while (!condition()) {
    if (machine.clock_ns >= until_ns || self.killed) return false;
    if (&self == tasks.main) tasks.main_waited = true;
    self.wake_ns = until_ns;
    self.events = events;
    self.condition = &condition;
    self.waiting = true;
    if (!self.timer && (others == Others::run || may_switch())) tasks.holder = nullptr;
    run_others();
    self.condition = nullptr;
  }
  return true;
}

void sleep_until(std::int64_t until_ns, Others others) {
  wait_for(
      until_ns, 0, [] { return false; }, others);
}

bool wait_in_queue(const void* object, std::int64_t until_ns) {
  Task& self = *tasks.current;
  if (self.killed) return false;
  self.granted = false;
  self.object = object;
  self.wake_ns = until_ns;
  self.events = 0;
  self.condition = nullptr;
  become_ready(self);  // its place in the queue
  self.waiting = true;
  if (!self.timer) tasks.holder = nullptr;
  run_others();
  return self.granted;
}

Task* grant(const void* object) {
  Task* first = nullptr;
  for (const auto& task : all()) {
    if (task->waiting && task->object == object && (!first || task->order < first->order)) first = task.get();
  }
  if (first) {
    wake(*first);
    first->granted = true;
  }
  return first;
}

void grant_all(const void* object) {
  while (grant(object)) {}
}

Task* make_task(std::string name, std::function<void*()> code, std::size_t stack_bytes, int priority,
                const pthread_attr_t* attributes) {
  static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  if (!create || all().size() >= 4096 ||
      std::count_if(all().begin(), all().end(), [](const auto& t) { return !t->ended; }) >= most_tasks)
    return nullptr;
  auto task = std::make_unique<Task>();
  task->number = ++last_number;
  task->name = std::move(name);
  task->code = std::move(code);
  task->priority = priority;
  pthread_attr_t own_attributes;
  pthread_attr_init(&own_attributes);
  if (!attributes) {
    const std::size_t page = 4096;
    pthread_attr_setstacksize(&own_attributes,
                              std::clamp(stack_bytes, least_stack, most_stack) / page * page);
  } else {
    int detached = 0;
    pthread_attr_getdetachstate(attributes, &detached);
    task->detached = detached == PTHREAD_CREATE_DETACHED;
  }
  const int failure = create(&task->thread, attributes ? attributes : &own_attributes, run_thread,
                             task.get());
  pthread_attr_destroy(&own_attributes);
  if (failure != 0) return nullptr;
  all().push_back(std::move(task));
  return all().back().get();
}

void start(Task& task) {
  task.started = true;
  become_ready(task);
}

void kill_task(Task& task) {
  if (task.ended || task.killed) return;
  task.killed = true;
  if (&task == tasks.current) pthread_exit(PTHREAD_CANCELED);
  task.started = true;
  task.waiting = false;
  task.killer = tasks.current;
  pass_baton(task);
  await_baton(*task.killer);
  if (task.detached && !task.is_own) forget(task);
}

void suspend(Task& task) {
  task.suspended = true;
  if (&task != tasks.current) return;
  tasks.holder = nullptr;
  run_others();
}

void resume(Task& task) {
  if (!task.started) return start(task);
  if (!task.suspended) return;
  task.suspended = false;
  become_ready(task);
}

void run_next(Task& task) {
  resume(task);
  if (&task == tasks.current || !task.can_run()) return;
  become_ready(*tasks.current);
  switch_to(task);
}

Task* find_task(pthread_t thread) {
  for (const auto& task : all()) {
    if (pthread_equal(task->thread, thread) && !(task->ended && task->is_own)) return task.get();
  }
  return nullptr;
}

bool exists(const Task* task) {
  return std::any_of(all().begin(), all().end(), [&](const auto& t) { return t.get() == task; });
}

int live_tasks() {
  return static_cast<int>(
      std::count_if(all().begin(), all().end(), [](const auto& t) { return !t->ended && !t->timer; }));
}

void forget(Task& task) {
  if (tasks.holder == &task) tasks.holder = nullptr;
  std::erase_if(all(), [&](const auto& t) { return t.get() == &task; });
}

void turn_came() { events_came = true; }

}  // namespace robios
