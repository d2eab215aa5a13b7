#pragma once
/// Tasks of the program: its threads, those of OSSpawn and its timers. Each is a thread of the system, one of them runs at a time.
///
/// Order     a task runs until it waits, or gives way at a call. The next one is the ready task of the highest priority that has
///           been ready longest. Timers come before all, and return to the task that they interrupted.
/// Modes     preempt: at a call whose time ends the task's slice, and whenever a task of higher priority has become ready, the
///           next task runs. coop: only when a task gives way. Programs without OSMTInit: preempt.
/// Time      slices are counted in the cost of calls, also when delays are off.
#include <pthread.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace robios {

inline constexpr std::int64_t slice_ns = 10'000'000;

struct Task {
  int number = 0;
  int uid = 0;
  int priority = 0;
  bool timer = false;       ///< runs before all others
  bool background = false;  ///< runs only when no other task can
  bool started = false, waiting = false, suspended = false, ended = false;
  bool killed = false;   ///< ends as soon as it runs
  bool granted = false;  ///< got what it waited for
  bool is_own = false;   ///< of OSSpawn or OSAttachTimer; otherwise of pthread_create
  bool detached = false;
  Task* killer = nullptr;  ///< runs again when this task has ended
  void* result = nullptr;
  std::uint64_t order = 0;  ///< since when it is ready
  std::int64_t wake_ns = 0;
  std::uint32_t events = 0;
  const void* object = nullptr;                      ///< a mutex, condition or semaphore that it waits for
  const std::function<bool()>* condition = nullptr;  ///< looked at when events have come
  std::atomic<std::uint32_t> baton{0};
  pthread_t thread{};
  std::string name;
  std::function<void*()> code;

  bool can_run() const { return started && !waiting && !suspended && !ended; }
};

enum class Mode : int { coop, preempt };
/// Whether others may run while a task waits: by_mode as the processor of RoBIOS does, where OSWait keeps it when cooperative.
enum class Others { run, by_mode };

struct Tasks {
  Mode mode = Mode::preempt;
  bool multitasking = false;  ///< OSMTInit was called
  bool forbidden = false;
  bool begun = false;        ///< main started the others
  bool main_waited = false;  ///< since it did
  Task* current = nullptr;
  Task* holder = nullptr;  ///< has the processor when nothing may be switched
  Task* main = nullptr;
  std::int64_t slice_start_ns = 0;
};
extern Tasks tasks;

void begin_tasks();
/// main returns. If all that it did since it started the tasks was to return, they go on until none can.
void main_returns();
/// Ends the process if the calling thread is one that this library does not know.
void check_thread();
/// At each call: others that have come first run.
void let_others_run();
/// The current task goes behind those of its priority.
void give_way();
/// Waits until `condition` holds, which is looked at when one of `events` may have come, or until `until_ns`: false.
bool wait_for(std::int64_t until_ns, std::uint32_t events, const std::function<bool()>& condition,
              Others others);
void sleep_until(std::int64_t until_ns, Others others);
/// Waits in the queue of `object` until grant() chooses this task, or until `until_ns`: false.
bool wait_in_queue(const void* object, std::int64_t until_ns);
/// Ends the waiting of the task that has waited longest for `object`.
Task* grant(const void* object);
void grant_all(const void* object);

/// New task, not yet started; nullptr: the system has no more threads.
Task* make_task(std::string name, std::function<void*()> code, std::size_t stack_bytes, int priority,
                const pthread_attr_t* attributes);
void start(Task& task);
void kill_task(Task& task);  ///< does not return if it is the current one
void suspend(Task& task);
void resume(Task& task);
void run_next(Task& task);
Task* find_task(pthread_t thread);
bool exists(const Task* task);
int live_tasks();  ///< without timers
void forget(Task& task);

/// New senses have come: conditions are looked at.
void turn_came();

}  // namespace robios
