/* Types and constants of RoBIOS-7. */
#ifndef ROBIOS7_TYPES_H
#define ROBIOS7_TYPES_H

#if defined(__GNUC__)
#pragma GCC system_header
#endif

#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 /* usleep, M_PI and others with every -std=, if this is the first header */
#endif
#include <math.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

typedef int COLOR; /* 0x00RRGGBB */
typedef unsigned char BYTE;
typedef int TIMER;

typedef struct {
  pthread_t thread;
  int identifier;
} TASK;
typedef sem_t SEMA;

#ifndef TRUE
#define TRUE 1
#endif
#ifndef FALSE
#define FALSE 0
#endif
#ifndef M_PI
#define M_PI 3.14159265358979323846
#endif

/* Machine types */
#define VEHICLE 1
#define PLATFORM 2
#define WALKER 3

/* Picture sizes */
#define QQVGA 0
#define QVGA 1
#define VGA 2
#define CAM1MP 3
#define CAMHD 4
#define CAM5MP 5
#define CUSTOM 10

#define QQVGA_X 160
#define QQVGA_Y 120
#define QVGA_X 320
#define QVGA_Y 240
#define VGA_X 640
#define VGA_Y 480
#define CAM1MP_X 1296
#define CAM1MP_Y 730
#define CAMHD_X 1920
#define CAMHD_Y 1080
#define CAM5MP_X 2592
#define CAM5MP_Y 1944

#define QQVGA_PIXELS (QQVGA_X * QQVGA_Y)
#define QVGA_PIXELS (QVGA_X * QVGA_Y)
#define VGA_PIXELS (VGA_X * VGA_Y)
#define CAM1MP_PIXELS (CAM1MP_X * CAM1MP_Y)
#define CAMHD_PIXELS (CAMHD_X * CAMHD_Y)
#define CAM5MP_PIXELS (CAM5MP_X * CAM5MP_Y)

#define QQVGA_SIZE (QQVGA_PIXELS * 3)
#define QVGA_SIZE (QVGA_PIXELS * 3)
#define VGA_SIZE (VGA_PIXELS * 3)
#define CAM1MP_SIZE (CAM1MP_PIXELS * 3)
#define CAMHD_SIZE (CAMHD_PIXELS * 3)
#define CAM5MP_SIZE (CAM5MP_PIXELS * 3)

typedef BYTE QQVGAcol[QQVGA_SIZE];
typedef BYTE QQVGAgray[QQVGA_PIXELS];
typedef BYTE QVGAcol[QVGA_SIZE];
typedef BYTE QVGAgray[QVGA_PIXELS];
typedef BYTE VGAcol[VGA_SIZE];
typedef BYTE VGAgray[VGA_PIXELS];
typedef BYTE CAM1MPcol[CAM1MP_SIZE];
typedef BYTE CAM1MPgray[CAM1MP_PIXELS];
typedef BYTE CAMHDcol[CAMHD_SIZE];
typedef BYTE CAMHDgray[CAMHD_PIXELS];
typedef BYTE CAM5MPcol[CAM5MP_SIZE];
typedef BYTE CAM5MPgray[CAM5MP_PIXELS];

/* Colours */
#define RED 0xFF0000
#define GREEN 0x00FF00
#define BLUE 0x0000FF
#define WHITE 0xFFFFFF
#define GRAY 0x808080
#define BLACK 0x000000
#define ORANGE 0xFFA500
#define SILVER 0xC0C0C0
#define LIGHTGRAY 0xD3D3D3
#define DARKGRAY 0xA9A9A9
#define NAVY 0x000080
#define CYAN 0x00EEEE
#define TEAL 0x008080
#define MAGENTA 0xFF00FF
#define PURPLE 0x800080
#define MAROON 0x800000
#define YELLOW 0xFFFF00
#define OLIVE 0x9ACD32

/* Fonts */
#define HELVETICA 0
#define TIMES 1
#define COURIER 2
#define NORMAL 0
#define BOLD 1
#define ITALICS 2

/* Modes of LCDSetMode */
#define BGCOL_TRANSPARENT 0x01
#define BGCOL_NOTRANSPARENT 0x10
#define BGCOL_INVERSE 0x02
#define BGCOL_NOINVERSE 0x20
#define FGCOL_INVERSE 0x04
#define FGCOL_NOINVERSE 0x40
#define AUTOREFRESH 0x0001
#define NOAUTOREFRESH 0x0100
#define SCROLLING 0x0002
#define NOSCROLLING 0x0200
#define LINEFEED 0x0004
#define NOLINEFEED 0x0400
#define SHOWMENU 0x0008
#define HIDEMENU 0x0800
#define LISTMENU 0x0010
#define CLASSICMENU 0x1000
#define FB_ROTATE 0x0080
#define FB_NOROTATION 0x8000

/* Keys */
#define KEY1 1
#define KEY2 2
#define KEY3 4
#define KEY4 8
#define ANYKEY ((int)0xFFFFFFFF)
#define NOKEY 0

/* Distance sensors */
#define PSD_FRONT 1
#define PSD_LEFT 2
#define PSD_RIGHT 3
#define PSD_BACK 4
#define PSD_OUT_OF_RANGE 9999

#endif
