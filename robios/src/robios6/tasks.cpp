#include <cstdio>
#include <cstdlib>

#include "../clocks.h"
#include "api.h"

using namespace robios;

namespace {

Task* task_of(struct tcb* thread) {
  auto* const task = reinterpret_cast<Task*>(thread);
  if (!thread) return tasks.current;
  return exists(task) && !task->ended && !task->timer ? task : nullptr;
}

/// In main the first of these calls starts the tasks. Cooperative: main goes on when no other can run by itself; preemptive: when
/// none is ready.
void give_way_of_main() {
  if (tasks.multitasking && tasks.current == tasks.main) {
    tasks.main->background = tasks.mode == Mode::coop;
    tasks.main->priority = MIN_PRI - 1;
    tasks.main_waited = false;
    tasks.begun = true;
  }
  give_way();
}

struct tcb* spawn(const char* name, void (*code)(), int stack_size, int priority, int uid) {
  if (!code || priority < MIN_PRI || priority > MAX_PRI) return nullptr;
  Task* const task = make_task(
      name ? name : "",
      [code]() -> void* {
        code();
        return nullptr;
      },
      stack_size < 0 ? 0 : static_cast<std::size_t>(stack_size), priority, nullptr);
  if (!task) return nullptr;
  task->uid = uid;
  task->is_own = task->detached = true;
  return reinterpret_cast<struct tcb*>(task);
}

}  // namespace

extern "C" {

int OSMTInit(BYTE mode) {
  enter(Call::OSMTInit);
  if (mode != COOP && mode != PREEMPT) return failed;
  tasks.mode = mode == COOP ? Mode::coop : Mode::preempt;
  tasks.forbidden = mode == PREEMPT;
  tasks.multitasking = true;
  return ok;
}
struct tcb* OSSpawn(const char* name, void (*code)(void), int stack_size, int priority, int uid) {
  enter(Call::OSSpawn);
  if (!tasks.multitasking) {
    tasks.mode = Mode::coop;
    tasks.multitasking = true;
  }
  return spawn(name, code, stack_size, priority, uid);
}
int OSMTStatus() {
  enter(Call::OSMTStatus);
  return !tasks.multitasking ? NOTASK : tasks.mode == Mode::coop ? COOP : PREEMPT;
}
int OSReady(struct tcb* thread) {
  enter(Call::OSReady);
  Task* const task = task_of(thread);
  if (!task) return failed;
  resume(*task);
  let_others_run();
  return ok;
}
int OSSuspend(struct tcb* thread) {
  enter(Call::OSSuspend);
  Task* const task = task_of(thread);
  if (!task) return failed;
  suspend(*task);
  return ok;
}
int OSReschedule() {
  enter(Call::OSReschedule);
  give_way_of_main();
  return ok;
}
int OSYield() {
  enter(Call::OSYield);
  give_way_of_main();
  return ok;
}
int OSRun(struct tcb* thread) {
  enter(Call::OSRun);
  Task* const task = task_of(thread);
  if (!task) return failed;
  run_next(*task);
  return ok;
}
int OSGetUID(struct tcb* thread) {
  enter(Call::OSGetUID);
  const Task* const task = task_of(thread);
  return task ? task->uid : -1;
}
int OSKill(struct tcb* thread) {
  enter(Call::OSKill);
  Task* const task = task_of(thread);
  if (!task) return failed;
  kill_task(*task);
  return ok;
}
int OSExit(int code) {
  enter(Call::OSExit);
  if (live_tasks() == 1) exit(code);
  kill_task(*tasks.current);
  return ok;
}
int OSPanic(const char* message) {
  enter(Call::OSPanic);
  screen.clear();
  screen.print("PANIC!\n");
  screen.print(message ? message : "");
  std::fprintf(stderr, "OSPanic: %s\n", message ? message : "");
  exit(1);
}
int OSSleep(int n) {
  enter(Call::OSSleep);
  if (n < 0) return failed;
  sleep_until(after(n * (10 * millisecond)), Others::run);
  return ok;
}
int OSForbid() {
  enter(Call::OSForbid);
  tasks.forbidden = true;
  return ok;
}
int OSPermit() {
  enter(Call::OSPermit);
  tasks.forbidden = false;
  if (tasks.mode == Mode::preempt && tasks.multitasking && tasks.current == tasks.main) give_way_of_main();
  return ok;
}

int OSSemInit(struct sem* semaphore, int value) {
  enter(Call::OSSemInit);
  if (!semaphore || value < 0) return failed;
  *semaphore = {value, 0};
  return ok;
}
int OSSemP(struct sem* semaphore) {
  enter(Call::OSSemP);
  if (!semaphore) return failed;
  if (semaphore->val > 0) {
    semaphore->val--;
    return ok;
  }
  return wait_in_queue(semaphore, never) ? ok : failed;
}
int OSSemV(struct sem* semaphore) {
  enter(Call::OSSemV);
  if (!semaphore) return failed;
  if (!grant(semaphore)) semaphore->val++;
  let_others_run();
  return ok;
}

}  // extern "C"
