/* Sends and receives messages and takes pictures at random times, and judges by its own clock what comes: nothing is from the
 * future, every message comes once and in order. Ends with a line of numbers, or with code 1 and what was wrong.
 *
 * Messages   "kind number time": b to all, u to one robot; the number counts those of the kind and receiver, the time [ns] is
 *            that at which it was sent.
 * Pictures   the column of the red hand tells the tick at whose end the picture was taken, modulo CODES.
 * -D         SEED, END_MS, STEP_NS (length of a tick), AIR_NS (from the beginning of a packet to its arrival), LAG (ticks by
 *            which a picture may be old), CODES (columns are 2 pixels of 160 wide each). */
#include "eyebot.h"

#define ROBOTS 16

static int sent_to_all, sent_to[ROBOTS], heard_all[ROBOTS], heard[ROBOTS];
static int sent, expected, received, pictures, me, robots;
static BYTE picture[QQVGA_SIZE];

static long long now_ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * 1000000000LL + t.tv_nsec;
}

static void fail(const char *what, long long a, long long b) {
  printf("wrong: %s, %lld and %lld at %lld\n", what, a, b, now_ns());
  exit(1);
}

static int coin(int n) { return rand() % n; }

static void send_one(void) {
  char text[64];
  int to = coin(3) ? 0 : 1 + coin(robots);
  long long begin;
  if (to == me) to = 0;
  begin = now_ns();
  /* Its cost passes before it is sent. */
  sprintf(text, "%c %d %lld", to ? 'u' : 'b', to ? sent_to[to] : sent_to_all, begin + 2000000);
  if (RADIOSend(to, text) != 0) fail("refused", to, 0);
  if (now_ns() < begin + 2000000) fail("a call that cost nothing", begin, now_ns());
  if (to) sent_to[to]++;
  else sent_to_all++;
  sent++;
  expected += to ? 1 : robots - 1;
}

/* Waits for one if there is none. */
static void take_one(void) {
  char text[64], kind;
  int from, number, *last;
  long long time, now;
  RADIOReceive(&from, text, sizeof text);
  now = now_ns();
  if (sscanf(text, "%c %d %lld", &kind, &number, &time) != 3) fail("a message", from, 0);
  if (now < time) fail("a message from the future", time, now);
  /* A packet begins in the tick at whose end its slot has ended, at the earliest a tick before it was sent. */
  if (now < time - STEP_NS + AIR_NS) fail("a message that came too early", time, now);
  last = kind == 'u' ? &heard[from] : &heard_all[from];
  if (number != *last) fail("a message out of its order", number, *last);
  ++*last;
  received++;
}

static void take_all(void) {
  while (RADIOCheck() > 0) take_one();
}

static void take_picture(void) {
  const long long begin = now_ns();
  long long now, tick;
  int x, sum = 0, n = 0, code, age;
  CAMGet(picture);
  now = now_ns();
  for (x = 0; x < QQVGA_X; x++) {
    const BYTE *p = picture + 3 * (QQVGA_Y / 2 * QQVGA_X + x);
    if (p[0] > 60 && p[0] > 3 * p[1] && p[0] > 3 * p[2]) sum += x, n++;
  }
  if (n == 0) fail("no hand", 0, 0);
  code = (int)((sum * 2 / n + 1 - (160 - 2 * CODES)) / 4); /* the middle of the hand, in half pixels */
  tick = now / STEP_NS;
  age = (int)(((tick - code) % CODES + CODES) % CODES);
  if (age > CODES / 2) fail("a picture from the future, in ticks", CODES - age, code);
  if (age > LAG) fail("an old picture, in ticks", age, code);
  if ((tick - age) * STEP_NS < begin) fail("a picture of before its call", tick - age, begin);
  pictures++;
}

int main(void) {
  int ids[256], x, y, phi;
  me = OSMachineID();
  robots = RADIOStatus(ids);
  srand(SEED * 100 + me);
  RADIOInit();
  CAMInit(QQVGA);
  while (now_ns() < END_MS * 1000000LL) {
    switch (coin(10)) {
      case 0:
      case 1:
      case 2: send_one(); break;
      case 3:
      case 4: OSWait(coin(60)); break;
      case 5: LCDSetPrintf(coin(5), 0, "%d", sent); break;
      case 6:
        if (coin(2) == 0) take_picture();
        break;
      case 7: VWGetPosition(&x, &y, &phi); break;
      case 8: /* half of the robots, so that the others send */
        if (me % 2 == 1 && now_ns() < (END_MS - 5000) * 1000000LL) take_one();
        break;
      default: usleep(coin(20000));
    }
    take_all();
  }
  /* What is under way. */
  for (x = 0; x < 100; x++) {
    OSWait(20);
    take_all();
  }
  printf("sent %d expected %d received %d pictures %d\n", sent, expected, received, pictures);
  return 0;
}
