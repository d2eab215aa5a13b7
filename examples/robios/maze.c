/* Maze: explore it, find the cell that is farthest from the start, drive there by the shortest way, and back.
 *
 * Robot:  two wheels, PSDs in front, on the left and on the right (LabBot) in the middle of a cell of a maze of square cells.
 * Result: the screen shows the map while it grows, with the shortest way in the end; the program prints the number of cells, the length of the
 *         way, "goal" when the robot stands in the farthest cell and "home" when it is back.
 *
 * The map begins with nothing known. Coordinates and directions are those of the start: 0 ahead (x), 1 left (y), 2 back, 3 right.
 * Flood fill gives each cell its distance to the nearest target along ways that are known to be free; the robot always goes to the
 * neighbour with the next smaller number. While it explores, all cells are targets where it has not been yet. */
#include "eyebot.h"

#define CELL 360 /* mm */
#define N 33     /* cells of the map, the start in the middle */
#define SPEED 400
#define BRAKE 120      /* mm before the end of a cell from where the robot drives the exact rest */
#define SLOT 20        /* mm that it drives in a time slot of 50 ms until an order acts */
#define FRONT_WALL 85   /* mm: reading of PSD_FRONT in the middle of a cell with a wall */
#define SIDE_WALL 105   /* and of PSD_LEFT and PSD_RIGHT */
#define IS_WALL(mm) ((mm) < 250)
#define FAR 9999
#define PIXELS 20 /* of a cell on the screen */

enum { UNKNOWN, FREE, WALL };

static const int dx[] = {1, 0, -1, 0}, dy[] = {0, 1, 0, -1};
static char side[N][N][4]; /* UNKNOWN, FREE or WALL */
static char visited[N][N];
static int distance[N][N];
static int x = N / 2, y = N / 2, direction = 0, cells = 0;

/* ------------------------------------------------------------------------------------------------------ screen */

/* Ahead is up on the screen. */
static int screen_x(int cell_y) { return 160 - (cell_y - N / 2) * PIXELS; }
static int screen_y(int cell_x) { return 205 - (cell_x - N / 2) * PIXELS; }

static void draw_wall(int cx, int cy, int d) {
  /* The two ends of the wall lie half a cell ahead of the middle, and half a cell to both sides. */
  int h = PIXELS / 2, mx = screen_x(cy) - dy[d] * h, my = screen_y(cx) - dx[d] * h;
  LCDLine(mx - dx[d] * h, my - dy[d] * h, mx + dx[d] * h, my + dy[d] * h, WHITE);
}

static void draw_cell(int cx, int cy, COLOR color) { LCDCircle(screen_x(cy), screen_y(cx), PIXELS / 4, color, 1); }

/* --------------------------------------------------------------------------------------------------------- map */

static void set_side(int d, int mm) {
  char value = IS_WALL(mm) ? WALL : FREE;
  d %= 4;
  if (side[x][y][d] != UNKNOWN) return;
  side[x][y][d] = value;
  side[x + dx[d]][y + dy[d]][(d + 2) % 4] = value;
  if (value == WALL) draw_wall(x, y, d);
}

static void look(void) {
  set_side(direction, PSDGet(PSD_FRONT));
  set_side(direction + 1, PSDGet(PSD_LEFT));
  set_side(direction + 3, PSDGet(PSD_RIGHT));
  if (!visited[x][y]) cells++;
  visited[x][y] = 1;
}

/* Distance of each cell to (tx, ty); with tx < 0 to the nearest cell that was not visited. */
static void flood(int tx, int ty) {
  int i, j, d, changed;
  for (i = 0; i < N; i++)
    for (j = 0; j < N; j++) distance[i][j] = (tx < 0 ? !visited[i][j] : i == tx && j == ty) ? 0 : FAR;
  do {
    changed = 0;
    for (i = 0; i < N; i++)
      for (j = 0; j < N; j++)
        for (d = 0; d < 4; d++)
          if (side[i][j][d] == FREE && distance[i + dx[d]][j + dy[d]] + 1 < distance[i][j]) {
            distance[i][j] = distance[i + dx[d]][j + dy[d]] + 1;
            changed = 1;
          }
  } while (changed);
}

/* Direction to a neighbour that is nearer; straight on if that is as good. */
static int downhill(int cx, int cy, int from) {
  static const int order[] = {0, 1, 3, 2};
  int i;
  for (i = 0; i < 4; i++) {
    int d = (from + order[i]) % 4;
    if (side[cx][cy][d] == FREE && distance[cx + dx[d]][cy + dy[d]] < distance[cx][cy]) return d;
  }
  return from;
}

/* ----------------------------------------------------------------------------------------------------- driving */

static int limited(int value, int most) { return value > most ? most : value < -most ? -most : value; }
static int wrapped(int degrees) { return (degrees % 360 + 540) % 360 - 180; }
static int heading(void) {
  int px, py, phi;
  VWGetPosition(&px, &py, &phi);
  return phi;
}

static void turn_to(int d) {
  int angle = wrapped(90 * d - heading());
  direction = d;
  if (angle == 0) return;
  VWTurn(angle, 180);
  VWWait();
}

/* mm that the robot must go to the left to be in the middle between walls; 0 without walls. */
static int off_middle(void) {
  int left = PSDGet(PSD_LEFT), right = PSDGet(PSD_RIGHT);
  if (IS_WALL(left) && IS_WALL(right)) return (left - right) / 2;
  if (IS_WALL(left)) return left - SIDE_WALL;
  if (IS_WALL(right)) return SIDE_WALL - right;
  return 0;
}

/* One cell ahead: along the middle between the walls, then exactly as far as the wall in front or the odometry says. */
static void drive_cell(void) {
  int x0, y0, px, py, phi, front, driven = 0;
  VWGetPosition(&x0, &y0, &phi);
  while (driven < CELL - BRAKE && PSDGet(PSD_FRONT) > FRONT_WALL + BRAKE) {
    int wanted = 90 * direction + limited(off_middle() / 3, 10);
    VWSetSpeed(SPEED, 3 * wrapped(wanted - phi));
    OSWait(50);
    VWGetPosition(&px, &py, &phi);
    driven = (int)lrint(hypot(px - x0, py - y0));
  }
  front = PSDGet(PSD_FRONT);
  VWStraight((IS_WALL(front) ? front - FRONT_WALL : CELL - driven) - SLOT, SPEED);
  VWWait();
}

static void go(int d) {
  turn_to(d);
  drive_cell();
  x += dx[d];
  y += dy[d];
}

/* Follows the numbers down to 0. */
static void descend(void) {
  while (distance[x][y] > 0) {
    go(downhill(x, y, direction));
    draw_cell(x, y, ORANGE);
  }
}

int main(void) {
  int i, j, gx, gy, longest = 0;
  const int home_x = x, home_y = y;
  LCDSetPrintf(0, 0, "exploring");
  VWSetPosition(0, 0, 0);
  look();
  turn_to(1); /* what is behind, too */
  look();
  draw_cell(x, y, RED);

  for (flood(-1, -1); distance[x][y] < FAR; flood(-1, -1)) {
    while (distance[x][y] > 0) { /* known ways to a new cell */
      go(downhill(x, y, direction));
    }
    look();
    draw_cell(x, y, GRAY);
    LCDSetPrintf(0, 0, "exploring: %2d cells", cells);
  }
  printf("explored %d cells\n", cells);

  flood(home_x, home_y);
  gx = home_x;
  gy = home_y;
  for (i = 0; i < N; i++)
    for (j = 0; j < N; j++)
      if (visited[i][j] && distance[i][j] > longest) {
        longest = distance[i][j];
        gx = i;
        gy = j;
      }
  printf("the way to the goal has %d cells\n", longest);
  draw_cell(gx, gy, GREEN);

  LCDSetPrintf(0, 0, "to the goal: %2d cells", longest);
  flood(gx, gy);
  descend();
  printf("goal\n");
  AUBeep();
  draw_cell(gx, gy, GREEN);

  LCDSetPrintf(0, 0, "home                 ");
  flood(home_x, home_y);
  descend();
  turn_to(0);
  printf("home\n");
  return 0;
}
