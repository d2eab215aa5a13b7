/* Soccer, two against two: find the ball, drive behind it, push it into the other goal. The one who is nearer to the ball plays it, the other one
 * guards the goal; team-mates agree by radio.
 *
 * Robots: four with two wheels, camera, PSD in front, radio (LabBot); 1 and 2 are a team, 3 and 4 the other one.
 * Result: balls in goals (soccer.yaml counts them). The screen shows the role and where the ball is.
 *
 * Coordinates [mm] are those of the team: its own goal is at (0, 0), x points to the other goal, y to the left. The starts of both teams are the same
 * in them. Places come from the odometry, the ball from its size and column in the picture. */
#include "eyebot.h"

#define LENGTH 2740
#define WIDTH 1520
#define BALL_RADIUS 50
#define BALL_HUE 17 /* orange, see ball.c */
#define TOLERANCE 8
#define FOCAL (QQVGA_X / 2 / 0.577) /* pixels; 0.577 is the tangent of half the angle of view */
#define SPEED 300
#define KICK 500     /* the ball rolls on for about a metre */
#define BEHIND 230   /* mm from the ball to the place where a push begins */
#define FORGET_MS 1500

typedef struct {
  double x, y;
} Point;

static BYTE picture[QQVGA_SIZE], hue[QQVGA_PIXELS], saturation[QQVGA_PIXELS], intensity[QQVGA_PIXELS];
static Point me, ball;
static int heading;               /* degrees */
static int ball_time = -FORGET_MS; /* OSGetCount() when it was known last */
static int mate_distance = 9999, attacker = 1;

static double wrapped(double degrees) { return remainder(degrees, 360); }
static double clipped(double value, double least, double most) { return value < least ? least : value > most ? most : value; }
static double distance(Point a, Point b) { return hypot(b.x - a.x, b.y - a.y); }
static double direction(Point from, Point to) { return atan2(to.y - from.y, to.x - from.x) * 180 / M_PI; }
static int ball_known(void) { return OSGetCount() - ball_time < FORGET_MS; }

static void locate(void) {
  int x, y;
  VWGetPosition(&x, &y, &heading);
  me.x = x;
  me.y = y;
}

/* Looks for the ball. Returns 1 if it is in the picture. */
static int see_ball(void) {
  int x, y, count = 0, left = QQVGA_X, right = -1, cut;
  CAMGet(picture);
  locate();
  IPCol2HSI(picture, hue, saturation, intensity);
  for (x = 0; x < QQVGA_X; x++) {
    int column = 0;
    for (y = 0; y < QQVGA_Y; y++) {
      int i = y * QQVGA_X + x;
      if (abs(hue[i] - BALL_HUE) <= TOLERANCE && saturation[i] > 180 && intensity[i] > 50) column++;
    }
    if (column < 2) continue;
    count += column;
    if (left > x) left = x;
    right = x;
  }
  if (count < 6) return 0;
  cut = left == 0 || right == QQVGA_X - 1; /* only a part of it is in the picture: it is near */
  double angle = heading + atan2(QQVGA_X / 2 - (left + right + 1) / 2.0, FOCAL) * 180 / M_PI;
  double away = cut ? 150 : 2 * BALL_RADIUS * FOCAL / (right - left + 1) + 85; /* from the middle of the robot */
  ball.x = clipped(me.x + away * cos(angle * M_PI / 180), 0, LENGTH);
  ball.y = clipped(me.y + away * sin(angle * M_PI / 180), -WIDTH / 2, WIDTH / 2);
  ball_time = OSGetCount();
  return 1;
}

/* What the mate sends: its distance to the ball, and where it sees the ball. */
static void talk(int mate, int seen) {
  char text[64];
  int from, mate_seen;
  Point told;
  sprintf(text, "%d %d %d %d", seen, (int)(ball_known() ? distance(me, ball) : 9999), (int)ball.x, (int)ball.y);
  RADIOSend(mate, text);
  while (RADIOCheck() == 1) {
    RADIOReceive(&from, text, sizeof(text));
    if (from != mate || sscanf(text, "%d %d %lf %lf", &mate_seen, &mate_distance, &told.x, &told.y) != 4) continue;
    if (mate_seen && !seen) {
      ball = told;
      ball_time = OSGetCount();
    }
  }
}

/* One step on the way to a place. Returns 1 at the place. */
static int go_to(Point place, int speed) {
  double angle = wrapped(direction(me, place) - heading), away = distance(me, place);
  if (away < 60) return 1;
  VWSetSpeed(fabs(angle) > 50 ? 0 : (int)clipped(2 * away, 60, speed), (int)clipped(2.5 * angle, -120, 120));
  return 0;
}

static void face(Point place) {
  VWSetSpeed(0, (int)clipped(2.5 * wrapped(direction(me, place) - heading), -100, 100));
}

/* Waits for the end of a way, but not for ever: something may be behind the robot. */
static void wait_for_drive(void) {
  int begin = OSGetCount();
  while (!VWDone() && OSGetCount() - begin < 1000) OSWait(50);
}

/* Back, or ahead if that was of no use, and turn. */
static void get_free(void) {
  static int way = 120;
  way = PSDGet(PSD_FRONT) < 150 ? -120 : -way;
  VWStraight(way, SPEED);
  wait_for_drive();
  VWTurn(rand() % 2 ? 50 : -50, 150);
  wait_for_drive();
}

static void push(double off) {
  /* A little to the outer side of the ball, so that it moves towards the line to the goal. */
  double angle = wrapped(direction(me, ball) + clipped(0.8 * off, -15, 15) - heading);
  VWSetSpeed(fabs(angle) > 40 ? 0 : KICK, (int)clipped(3 * angle, -120, 120));
}

static void attack(void) {
  const Point goal = {LENGTH + 100, 0};
  double shot = direction(ball, goal);
  double off = wrapped(direction(me, ball) - shot); /* 0: robot, ball and goal are in a line */
  int side = off > 0 ? -1 : 1;
  Point place;
  if (fabs(off) < 25 && distance(me, ball) < BEHIND + 150) {
    push(off);
    return;
  }
  /* Behind the ball; if the ball is in the way, around it first, on the side where the robot is. */
  double turned = (fabs(off) > 90 ? shot - 90 * side : shot) * M_PI / 180;
  place.x = clipped(ball.x - BEHIND * cos(turned), 110, LENGTH - 110);
  place.y = clipped(ball.y - BEHIND * sin(turned), -WIDTH / 2 + 110, WIDTH / 2 - 110);
  if (go_to(place, SPEED)) push(0); /* near a wall no better place is to be had */
}

static void guard(void) {
  Point place = {300, 0};
  if (ball_known()) place.y = clipped(ball.y / 2, -250, 250);
  if (go_to(place, SPEED) && ball_known()) face(ball);
}

int main(void) {
  const int id = OSMachineID(), mate = ((id - 1) ^ 1) + 1;
  int blocked = 0;
  RADIOInit();
  CAMInit(QQVGA);
  LCDImageStart(0, 48, QQVGA_X, QQVGA_Y);
  if (id % 2 == 1) VWSetPosition(900, -200, 0);
  else VWSetPosition(400, 200, 0);
  for (;;) {
    int seen = see_ball(), mine;
    talk(mate, seen);
    mine = ball_known() ? (int)distance(me, ball) : 9999;
    /* A little in favour of the one that attacks already. */
    attacker = mine - (attacker ? 100 : -100) < mate_distance || (mine == 9999 && id % 2 == 1);
    LCDSetPrintf(0, 0, "%d %-7s %s", id, attacker ? "attack" : "guard", seen ? "sees" : "    ");
    LCDSetPrintf(1, 0, "ball %5.0f %5.0f", ball.x, ball.y);
    LCDImage(picture);
    blocked = PSDGet(PSD_FRONT) < 60 && !(seen && mine < 250) ? blocked + 1 : 0;
    if (blocked > 4 || VWStalled()) {
      get_free();
      blocked = 0;
    } else if (!ball_known()) {
      VWSetSpeed(0, id % 2 ? 90 : -90); /* look around */
    } else if (attacker) {
      attack();
    } else {
      guard();
    }
  }
}
