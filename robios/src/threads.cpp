/// pthreads and semaphores of the C library, on tasks.h: what these functions keep is in their own objects, as the C library
/// lays them out, so that its initialisers hold.
#include <dlfcn.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>

#include <cerrno>
#include <cstring>

#include "clocks.h"
#include "interpose.h"
#include "machine.h"
#include "tasks.h"

using namespace robios;

namespace {

bool in_task() { return machine.memory && tasks.current; }

/// First of each of these calls.
void enter_thread() {
  if (in_task()) enter(Call::threads);
}

int me() { return in_task() ? tasks.current->number + 1 : 1; }
std::int64_t deadline(const timespec* t) { return t ? deadline_ns(*t) : never; }

// Mutexes. The lock goes to the one that waits longest, so that nobody takes it again and again.

int kind(const pthread_mutex_t* m) { return m->__data.__kind & 3; }

int take(pthread_mutex_t* m, bool waits, std::int64_t until_ns) {
  auto& d = m->__data;
  if (d.__lock == 0) {
    d.__lock = 1;
    d.__owner = me();
    d.__count = 1;
    return 0;
  }
  if (d.__owner == me() && kind(m) == PTHREAD_MUTEX_RECURSIVE) {
    d.__count++;
    return 0;
  }
  if (!waits) return EBUSY;
  if (d.__owner == me() && kind(m) == PTHREAD_MUTEX_ERRORCHECK) return EDEADLK;
  if (!in_task()) return EDEADLK;
  if (!wait_in_queue(m, until_ns)) return ETIMEDOUT;
  d.__lock = 1;
  d.__owner = me();
  d.__count = 1;
  return 0;
}

int give(pthread_mutex_t* m) {
  auto& d = m->__data;
  if (d.__lock == 0 || (d.__owner != me() && kind(m) != PTHREAD_MUTEX_NORMAL)) return EPERM;
  if (kind(m) == PTHREAD_MUTEX_RECURSIVE && --d.__count > 0) return 0;
  d.__owner = 0;
  d.__count = 0;
  Task* const next = in_task() ? grant(m) : nullptr;
  d.__lock = next ? 1 : 0;  // locked for the next one
  if (next) d.__owner = next->number + 1;
  return 0;
}

int wait_on(pthread_cond_t* c, pthread_mutex_t* m, std::int64_t until_ns) {
  if (!in_task()) return EINVAL;
  if (int failure = give(m)) return failure;
  const bool came = wait_in_queue(c, until_ns);
  take(m, true, never);
  return came ? 0 : ETIMEDOUT;
}

// Semaphores: the value is the first int.

int& value(sem_t* s) { return *reinterpret_cast<int*>(s); }

int take(sem_t* s, bool waits, std::int64_t until_ns) {
  if (value(s) > 0) {
    value(s)--;
    return 0;
  }
  if (!waits) {
    errno = EAGAIN;
    return -1;
  }
  if (in_task() && wait_in_queue(s, until_ns)) return 0;
  errno = ETIMEDOUT;
  return -1;
}

// Reader-writer locks: readers and writer in the first two ints.

struct Lock {
  int readers, writer;
};
Lock& lock_of(pthread_rwlock_t* l) { return *reinterpret_cast<Lock*>(l); }

int take(pthread_rwlock_t* l, bool write, bool waits, std::int64_t until_ns) {
  Lock& k = lock_of(l);
  while (k.writer != 0 || (write && k.readers > 0)) {
    if (!waits) return EBUSY;
    if (!in_task() || k.writer == me()) return EDEADLK;
    if (!wait_in_queue(l, until_ns)) return ETIMEDOUT;
  }
  if (write) {
    k.writer = me();
  } else {
    k.readers++;
  }
  return 0;
}

struct Barrier {
  unsigned wanted, here;
};
Barrier& barrier_of(pthread_barrier_t* b) { return *reinterpret_cast<Barrier*>(b); }

int join(pthread_t thread, void** result, bool waits, std::int64_t until_ns) {
  static const auto next = reinterpret_cast<int (*)(pthread_t, void**)>(dlsym(RTLD_NEXT, "pthread_join"));
  if (Task* const task = find_task(thread)) {
    if (task == tasks.current) return EDEADLK;
    if (task->detached) return EINVAL;
    while (!task->ended) {
      if (!waits) return EBUSY;
      if (!wait_in_queue(task, until_ns) && !task->ended) return ETIMEDOUT;
    }
    const int failure = next(thread, result);
    if (failure == 0) forget(*task);
    return failure;
  }
  return ESRCH;
}

}  // namespace

ROBIOS_INTERPOSE(int, pthread_create, pthread_t* thread, const pthread_attr_t* attributes,
                 void* (*code)(void*), void* argument) {
  enter_thread();
  if (!code || !thread) return EINVAL;
  if (!in_task()) return EAGAIN;
  Task* const task = make_task(
      "thread", [code, argument] { return code(argument); }, 8u << 20, tasks.current->priority, attributes);
  if (!task) return EAGAIN;
  *thread = task->thread;
  start(*task);
  return 0;
}

ROBIOS_INTERPOSE(int, pthread_join, pthread_t thread, void** result) {
  enter_thread();
  return join(thread, result, true, never);
}
ROBIOS_INTERPOSE(int, pthread_tryjoin_np, pthread_t thread, void** result) {
  enter_thread();
  return join(thread, result, false, never);
}
ROBIOS_INTERPOSE(int, pthread_timedjoin_np, pthread_t thread, void** result, const timespec* until) {
  enter_thread();
  return join(thread, result, true, deadline(until));
}

ROBIOS_INTERPOSE(int, pthread_detach, pthread_t thread) {
  static const auto next = reinterpret_cast<int (*)(pthread_t)>(dlsym(RTLD_NEXT, "pthread_detach"));
  enter_thread();
  Task* const task = find_task(thread);
  if (!task) return ESRCH;
  if (task->detached) return EINVAL;
  task->detached = true;
  const int failure = next(thread);
  if (task->ended) forget(*task);
  return failure;
}

ROBIOS_INTERPOSE(int, pthread_cancel, pthread_t thread) {
  enter_thread();
  Task* const task = find_task(thread);
  if (!task) return ESRCH;
  kill_task(*task);
  return 0;
}

ROBIOS_INTERPOSE(int, sched_yield, void) {
  enter_thread();
  if (in_task()) give_way();
  return 0;
}
ROBIOS_INTERPOSE(int, pthread_yield, void) { return robios_sched_yield(); }

ROBIOS_INTERPOSE(int, pthread_mutex_lock, pthread_mutex_t* m) {
  enter_thread();
  return take(m, true, never);
}
ROBIOS_INTERPOSE(int, pthread_mutex_trylock, pthread_mutex_t* m) {
  enter_thread();
  return take(m, false, never);
}
ROBIOS_INTERPOSE(int, pthread_mutex_timedlock, pthread_mutex_t* m, const timespec* until) {
  enter_thread();
  return take(m, true, deadline(until));
}
ROBIOS_INTERPOSE(int, pthread_mutex_clocklock, pthread_mutex_t* m, clockid_t, const timespec* until) {
  enter_thread();
  return take(m, true, deadline(until));
}
ROBIOS_INTERPOSE(int, pthread_mutex_unlock, pthread_mutex_t* m) {
  enter_thread();
  return give(m);
}
ROBIOS_INTERPOSE(int, pthread_mutex_destroy, pthread_mutex_t* m) { return m->__data.__lock != 0 ? EBUSY : 0; }

ROBIOS_INTERPOSE(int, pthread_cond_wait, pthread_cond_t* c, pthread_mutex_t* m) {
  enter_thread();
  return wait_on(c, m, never);
}
ROBIOS_INTERPOSE(int, pthread_cond_timedwait, pthread_cond_t* c, pthread_mutex_t* m, const timespec* until) {
  enter_thread();
  return wait_on(c, m, deadline(until));
}
ROBIOS_INTERPOSE(int, pthread_cond_clockwait, pthread_cond_t* c, pthread_mutex_t* m, clockid_t,
                 const timespec* until) {
  enter_thread();
  return wait_on(c, m, deadline(until));
}
ROBIOS_INTERPOSE(int, pthread_cond_signal, pthread_cond_t* c) {
  enter_thread();
  if (in_task()) grant(c);
  return 0;
}
ROBIOS_INTERPOSE(int, pthread_cond_broadcast, pthread_cond_t* c) {
  enter_thread();
  if (in_task()) grant_all(c);
  return 0;
}
ROBIOS_INTERPOSE(int, pthread_cond_destroy, pthread_cond_t*) { return 0; }

ROBIOS_INTERPOSE(int, sem_init, sem_t* s, int, unsigned count) {
  enter_thread();
  if (count > SEM_VALUE_MAX) {
    errno = EINVAL;
    return -1;
  }
  std::memset(s, 0, sizeof(*s));
  value(s) = static_cast<int>(count);
  return 0;
}
ROBIOS_INTERPOSE(int, sem_destroy, sem_t*) { return 0; }
ROBIOS_INTERPOSE(int, sem_wait, sem_t* s) {
  enter_thread();
  return take(s, true, never);
}
ROBIOS_INTERPOSE(int, sem_trywait, sem_t* s) {
  enter_thread();
  return take(s, false, never);
}
ROBIOS_INTERPOSE(int, sem_timedwait, sem_t* s, const timespec* until) {
  enter_thread();
  return take(s, true, deadline(until));
}
ROBIOS_INTERPOSE(int, sem_clockwait, sem_t* s, clockid_t, const timespec* until) {
  enter_thread();
  return take(s, true, deadline(until));
}
ROBIOS_INTERPOSE(int, sem_post, sem_t* s) {
  enter_thread();
  if (value(s) == SEM_VALUE_MAX) {
    errno = EOVERFLOW;
    return -1;
  }
  if (!in_task() || !grant(s)) value(s)++;
  return 0;
}
ROBIOS_INTERPOSE(int, sem_getvalue, sem_t* s, int* to) {
  enter_thread();
  *to = value(s);
  return 0;
}

ROBIOS_INTERPOSE(int, pthread_rwlock_rdlock, pthread_rwlock_t* l) {
  enter_thread();
  return take(l, false, true, never);
}
ROBIOS_INTERPOSE(int, pthread_rwlock_tryrdlock, pthread_rwlock_t* l) {
  enter_thread();
  return take(l, false, false, never);
}
ROBIOS_INTERPOSE(int, pthread_rwlock_timedrdlock, pthread_rwlock_t* l, const timespec* until) {
  enter_thread();
  return take(l, false, true, deadline(until));
}
ROBIOS_INTERPOSE(int, pthread_rwlock_wrlock, pthread_rwlock_t* l) {
  enter_thread();
  return take(l, true, true, never);
}
ROBIOS_INTERPOSE(int, pthread_rwlock_trywrlock, pthread_rwlock_t* l) {
  enter_thread();
  return take(l, true, false, never);
}
ROBIOS_INTERPOSE(int, pthread_rwlock_timedwrlock, pthread_rwlock_t* l, const timespec* until) {
  enter_thread();
  return take(l, true, true, deadline(until));
}
ROBIOS_INTERPOSE(int, pthread_rwlock_unlock, pthread_rwlock_t* l) {
  enter_thread();
  Lock& k = lock_of(l);
  if (k.writer != 0) {
    k.writer = 0;
  } else if (k.readers > 0) {
    k.readers--;
  } else {
    return EPERM;
  }
  if (in_task() && k.readers == 0) grant_all(l);
  return 0;
}
ROBIOS_INTERPOSE(int, pthread_rwlock_init, pthread_rwlock_t* l, const pthread_rwlockattr_t*) {
  std::memset(l, 0, sizeof(*l));
  return 0;
}
ROBIOS_INTERPOSE(int, pthread_rwlock_destroy, pthread_rwlock_t*) { return 0; }

ROBIOS_INTERPOSE(int, pthread_barrier_init, pthread_barrier_t* b, const pthread_barrierattr_t*,
                 unsigned count) {
  if (count == 0) return EINVAL;
  std::memset(b, 0, sizeof(*b));
  barrier_of(b) = {count, 0};
  return 0;
}
ROBIOS_INTERPOSE(int, pthread_barrier_destroy, pthread_barrier_t*) { return 0; }
ROBIOS_INTERPOSE(int, pthread_barrier_wait, pthread_barrier_t* b) {
  enter_thread();
  Barrier& barrier = barrier_of(b);
  if (++barrier.here >= barrier.wanted) {
    barrier.here = 0;
    if (in_task()) grant_all(b);
    return PTHREAD_BARRIER_SERIAL_THREAD;
  }
  if (in_task()) wait_in_queue(b, never);
  return 0;
}

ROBIOS_INTERPOSE(int, pthread_spin_init, pthread_spinlock_t* l, int) {
  *l = 0;
  return 0;
}
ROBIOS_INTERPOSE(int, pthread_spin_destroy, pthread_spinlock_t*) { return 0; }
ROBIOS_INTERPOSE(int, pthread_spin_trylock, pthread_spinlock_t* l) {
  enter_thread();
  if (*l != 0) return EBUSY;
  *l = 1;
  return 0;
}
ROBIOS_INTERPOSE(int, pthread_spin_lock, pthread_spinlock_t* l) {
  enter_thread();
  if (*l != 0) {
    if (!in_task()) return EDEADLK;
    wait_in_queue(const_cast<int*>(l), never);
  }
  *l = 1;
  return 0;
}
ROBIOS_INTERPOSE(int, pthread_spin_unlock, pthread_spinlock_t* l) {
  enter_thread();
  *l = in_task() && grant(const_cast<int*>(l)) ? 1 : 0;
  return 0;
}

ROBIOS_INTERPOSE(int, pthread_once, pthread_once_t* once, void (*code)(void)) {
  enter_thread();
  constexpr int running = 1, done = 2;
  while (*once == running) {
    if (!in_task()) return EDEADLK;
    wait_in_queue(once, never);
  }
  if (*once == done) return 0;
  *once = running;
  code();
  *once = done;
  if (in_task()) grant_all(once);
  return 0;
}
