/* RoBIOS-7: ints, mm, degrees, ms. Reference: docs/robios.md. */
#ifndef ROBIOS7_EYEBOT_H
#define ROBIOS7_EYEBOT_H

#if defined(__GNUC__)
#pragma GCC system_header
#endif

#include "types.h"

#ifdef __cplusplus
#define ROBIOS_DEFAULT(x) = x
extern "C" {
#else
#define ROBIOS_DEFAULT(x)
#endif
#if defined(__GNUC__)
#define ROBIOS_PRINTF(at, first) __attribute__((__format__(__printf__, at, first)))
#else
#define ROBIOS_PRINTF(at, first)
#endif

/* Screen */
int LCDInit(void); /* of older releases: no effect */
int LCDRelease(void);
int LCDPrintf(const char* format, ...) ROBIOS_PRINTF(1, 2);
int LCDSetPrintf(int row, int column, const char* format, ...) ROBIOS_PRINTF(3, 4);
int LCDClear(void);
int LCDSetPos(int row, int column);
int LCDGetPos(int* row, int* column);
int LCDSetColor(COLOR foreground, COLOR background ROBIOS_DEFAULT(0));
int LCDSetFont(int font, int variation);
int LCDSetFontSize(int size);
int LCDSetMode(int mode);
int LCDMenu(const char* key1, const char* key2, const char* key3, const char* key4);
int LCDMenuI(int position, const char* label, COLOR foreground ROBIOS_DEFAULT(0xFFFFFF),
             COLOR background ROBIOS_DEFAULT(0));
int LCDGetSize(int* width, int* height);
int LCDPixel(int x, int y, COLOR color);
COLOR LCDGetPixel(int x, int y);
int LCDLine(int x1, int y1, int x2, int y2, COLOR color);
int LCDArea(int x1, int y1, int x2, int y2, COLOR color, int fill ROBIOS_DEFAULT(1));
int LCDCircle(int x, int y, int radius, COLOR color, int fill ROBIOS_DEFAULT(1));
int LCDImageSize(int type);
int LCDImageStart(int x, int y, int width, int height);
int LCDImage(BYTE* rgb);
int LCDImageGray(BYTE* gray);
int LCDImageBinary(BYTE* binary); /* 0 black, otherwise white */
int LCDRefresh(void);

/* Keys and touch */
int KEYGet(void);
int KEYRead(void);
int KEYWait(int key);
int KEYGetXY(int* x, int* y);
int KEYReadXY(int* x, int* y);

/* Camera */
extern int CAMWIDTH, CAMHEIGHT, CAMPIXELS, CAMSIZE, CAMMODE;
int CAMInit(int resolution);
int CAMRelease(void);
int CAMGet(BYTE* rgb);
int CAMGetGray(BYTE* gray);

/* Image processing */
extern int IP_WIDTH, IP_HEIGHT, IP_PIXELS, IP_SIZE, IP_MODE;
int IPSetSize(int resolution);
int IPReadFile(const char* name, BYTE* image); /* 3 colour, 2 grey, 1 black and white, -1 error */
int IPWriteFile(const char* name, BYTE* rgb);
int IPWriteFileGray(const char* name, BYTE* gray);
void IPLaplace(BYTE* gray_in, BYTE* gray_out);
void IPSobel(BYTE* gray_in, BYTE* gray_out);
void IPCol2Gray(BYTE* rgb, BYTE* gray);
void IPGray2Col(BYTE* gray, BYTE* rgb);
void IPRGB2Col(BYTE* r, BYTE* g, BYTE* b, BYTE* rgb);
void IPCol2HSI(BYTE* rgb, BYTE* h, BYTE* s, BYTE* i);
void IPOverlay(BYTE* below, BYTE* above, BYTE* rgb);
void IPOverlayGray(BYTE* below, BYTE* above, COLOR color, BYTE* rgb);
COLOR IPPRGB2Col(BYTE r, BYTE g, BYTE b);
void IPPCol2RGB(COLOR color, BYTE* r, BYTE* g, BYTE* b);
void IPPCol2HSI(COLOR color, BYTE* h, BYTE* s, BYTE* i);
BYTE IPPRGB2Hue(BYTE r, BYTE g, BYTE b);
void IPPRGB2HSI(BYTE r, BYTE g, BYTE b, BYTE* h, BYTE* s, BYTE* i);

/* System */
int OSExecute(char* command, ...); /* refused; with and without a buffer for its output */
int OSVersion(char* text);
int OSVersionIO(char* text);
int OSMachineSpeed(void);
int OSMachineType(void);
int OSMachineName(char* name);
int OSMachineID(void);

/* Time */
int OSWait(int milliseconds);
TIMER OSAttachTimer(int scale, void (*function)(void));
int OSDetachTimer(TIMER timer);
int OSSetTime(int hours, int minutes, int seconds);
int OSGetTime(int* hours, int* minutes, int* seconds, int* ticks);
int OSGetCount(void); /* ms since the program's start */

/* Serial lines: none is there */
int SERInit(int interface, int baud, int handshake);
int SERSendChar(int interface, char byte);
int SERSend(int interface, const char* data, ...);
char SERReceiveChar(int interface);
int SERReceive(int interface, void* data, ...);
bool SERCheck(int interface);
int SERFlush(int interface);
int SERClose(int interface);

/* Audio */
int AUBeep(void);
int AUPlay(const char* file);
int AUDone(void);
int AUMicrophone(void);

/* Distances */
int PSDGet(int psd);
int PSDGetRaw(int psd);
int LIDARGet(int distance[]);
int LIDARSet(int range, int tilt, int points);
int SIMLaserScan(int distance[]);

/* Servos, motors, encoders */
int SERVOSet(int servo, int angle);
int SERVOSetRaw(int servo, int value);
int SERVORange(int servo, int low, int high);
int MOTORDrive(int motor, int speed);
int MOTORDriveRaw(int motor, int speed);
int MOTORPID(int motor, int p, int i, int d);
int MOTORPIDOff(int motor);
int MOTORSpeed(int motor, int ticks);
int ENCODERRead(int motor);
int ENCODERReset(int motor);

/* Driving by speed and turning rate */
int VWSetSpeed(int linear, int angular);
int VWGetSpeed(int* linear, int* angular);
int VWSetPosition(int x, int y, int phi);
int VWGetPosition(int* x, int* y, int* phi);
int VWStraight(int distance, int speed);
int VWTurn(int angle, int speed);
int VWCurve(int distance, int angle, int speed);
int VWDrive(int dx, int dy, int speed);
int VWRemain(void);
int VWDone(void);
int VWWait(void);
int VWStalled(void);
int VWControl(int Vv, int Tv, int Vw, int Tw);
int VWControlOff(void);
int VWDriveRemain(void);
int VWDriveDone(void);
int VWDriveWait(void);

/* Digital and analogue inputs and outputs */
int DIGITALSetup(int io, char direction);
int DIGITALRead(int io);
int DIGITALReadAll(void);
int DIGITALWrite(int io, int state);
int ANALOGRead(int channel);
int ANALOGVoltage(void);
int ANALOGRecord(int channel, int iterations);
int ANALOGTransfer(BYTE* buffer);

/* Infrared remote control: none is there */
int IRTVGet(void);
int IRTVRead(void);
int IRTVFlush(void);
int IRTVGetStatus(void);

/* Radio */
int RADIOInit(void);
int RADIOGetID(void);
int RADIOSend(int id, const char* text);
int RADIOReceive(int* id, char* buffer, int size);
int RADIOStatus(int ids[]);
int RADIORelease(void);
int RADIOCheckAny(void);
int RADIOCheckID(int* id);

/* Supervisor of the simulation */
void SIMGetRobot(int id, int* x, int* y, int* z, int* phi);
void SIMSetRobot(int id, int x, int y, int z, int phi);
void SIMGetObject(int id, int* x, int* y, int* z, int* phi);
void SIMSetObject(int id, int x, int y, int z, int phi);
int SIMGetRobotCount(void);
int SIMGetObjectCount(void);
/* Three clocks [ms]: of the program, of the simulation (beginning of the time slot), of the wall. Not in the original. */
int SIMGetVirtualTime(void);
int SIMGetSimulationTime(void);
int SIMGetRealTime(void);

#ifdef __cplusplus
}
/* Called with and without a place for the sender's id. */
static inline int RADIOCheck(void) { return RADIOCheckAny(); }
static inline int RADIOCheck(int* id) { return RADIOCheckID(id); }
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ > 201710L
#define ROBIOS_SECOND(a, b, ...) b
#define RADIOCheck(...) RADIOCheckID(ROBIOS_SECOND(0, __VA_OPT__(__VA_ARGS__, )(int*) 0, 0))
#else
#define RADIOCheck(...) \
  ((sizeof(#__VA_ARGS__) > 1 ? (int (*)())RADIOCheckID : (int (*)())RADIOCheckAny)(__VA_ARGS__))
#endif
#endif
