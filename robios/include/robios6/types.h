/* Types and constants of RoBIOS 5 and 6. */
#ifndef ROBIOS6_TYPES_H
#define ROBIOS6_TYPES_H

#if defined(__GNUC__)
#pragma GCC system_header
#endif

#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 /* usleep, M_PI and others with every -std=, if this is the first header */
#endif
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

typedef unsigned char BYTE;
typedef int BOOL;
#ifndef TRUE
#define TRUE 1
#endif
#ifndef FALSE
#define FALSE 0
#endif
#ifndef M_PI
#define M_PI 3.14159265358979323846
#endif

typedef float meter;
typedef float radians;
typedef float meterPerSec;
typedef float radPerSec;
typedef struct {
  meter x, y;
  radians phi;
} PositionType;
typedef struct {
  meterPerSec v;
  radPerSec w;
} SpeedType;

typedef int DeviceSemantics;
typedef int VWHandle;
typedef int PSDHandle; /* a bit; those of several sensors can be ORed */
typedef int MotorHandle;
typedef int QuadHandle;
typedef int ServoHandle;
typedef int BumpHandle;
typedef int IRHandle;
typedef int TimerHandle;
typedef void (*TimerFnc)(void);

/* Pictures: 80 x 60 within a border of one pixel */
#define imagecolumns 82
#define imagerows 62
typedef BYTE image[imagerows][imagecolumns];
typedef BYTE colimage[imagerows][imagecolumns][3];

/* Camera */
#define NORMAL 0
#define WIDE 1
#define TELE 2
#define NOINIT 255
#define INITERROR 254
#define NOCAM NOINIT
#define COLCAM 16 /* colour cameras from here */
#define CAMWAIT 10
#define FPS60 0
#define FPS30 1
#define FPS15 2
#define FPS7_5 3
#define FPS3_75 4
#define FPS1_875 5
#define FPS0_9375 6
#define FPS0_46875 7
#define AUTOBRIGHTNESS 0
#define NOAUTOBRIGHTNESS 1

/* Distance sensors */
#define PSD_OUT_OF_RANGE 9999

/* Keys */
#define KEY1 1
#define KEY2 2
#define KEY3 4
#define KEY4 8
#define ANYKEY 15

/* Modes of LCDMode */
#define SCROLLING 1
#define NOSCROLLING 2
#define CURSOR 4
#define NOCURSOR 8

/* Radio */
#define BROADCAST 0
#define MAXMSGLEN 35
#define RADIO_BLUETOOTH 1
#define RADIO_METRIX 2
typedef struct {
  int interface, speed, id, remoteOn, imageTransfer, debug;
} RadioIOParameters;
typedef struct {
  int master, active[16];
} RadioStatus;

/* Tasks */
#define COOP 0
#define PREEMPT 1
#define NOTASK 2 /* before OSMTInit */
#define MIN_PRI 1
#define MED_PRI 4
#define MAX_PRI 8
#define SSTACKSIZE 4096
struct tcb; /* of the library */
typedef struct tcb TASK;
struct sem {
  int val;      /* not below 0 */
  int reserved; /* of the library */
};

/* Serial lines */
#define SERIAL1 0
#define SERIAL2 1
#define SERIAL3 2
#define SER4800 4800
#define SER9600 9600
#define SER19200 19200
#define SER38400 38400
#define SER57600 57600
#define SER115200 115200
#define NONE 0
#define RTSCTS 1

/* Machine types */
#define VEHICLE 1
#define PLATFORM 2
#define WALKER 3

#endif
