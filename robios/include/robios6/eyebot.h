/* RoBIOS 5 and 6: handles, floats in SI units, times in 1/100 s. Reference: docs/robios.md. */
#ifndef ROBIOS6_EYEBOT_H
#define ROBIOS6_EYEBOT_H

#if defined(__GNUC__)
#pragma GCC system_header
#endif

#include "types.h"

#include "hdt_sem.h"

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#define ROBIOS_PRINTF(at, first) __attribute__((__format__(__printf__, at, first)))
#else
#define ROBIOS_PRINTF(at, first)
#endif

/* Driving by speed and turning rate */
VWHandle VWInit(DeviceSemantics semantics, int timescale);
int VWRelease(VWHandle handle);
int VWSetSpeed(VWHandle handle, meterPerSec v, radPerSec w);
int VWGetSpeed(VWHandle handle, SpeedType* vw);
int VWSetPosition(VWHandle handle, meter x, meter y, radians phi);
int VWGetPosition(VWHandle handle, PositionType* position);
int VWStartControl(VWHandle handle, float Vv, float Tv, float Vw, float Tw);
int VWStopControl(VWHandle handle);
int VWDriveStraight(VWHandle handle, meter delta, meterPerSec v);
int VWDriveTurn(VWHandle handle, radians delta, radPerSec w);
int VWDriveCurve(VWHandle handle, meter delta_l, radians delta_phi, meterPerSec v);
float VWDriveRemain(VWHandle handle);
int VWDriveDone(VWHandle handle);
int VWDriveReady(VWHandle handle);
int VWDriveWait(VWHandle handle);
int VWStalled(VWHandle handle);

/* Distances */
PSDHandle PSDInit(DeviceSemantics semantics);
int PSDRelease(void);
int PSDStart(PSDHandle handles, BOOL cycle);
int PSDStop(void);
BOOL PSDCheck(void);
int PSDGet(PSDHandle handle);
int PSDGetRaw(PSDHandle handle);

/* Camera */
int CAMInit(int mode);
int CAMRelease(void);
int CAMGetFrame(image* buffer);
int CAMGetColFrame(colimage* buffer, int convert);
int CAMGetFrameMono(BYTE* buffer);
int CAMGetFrameRGB(BYTE* buffer);
int CAMGetFrameBayer(BYTE* buffer);
int CAMSet(int brightness, int hue, int saturation);
int CAMGet(int* brightness, int* hue, int* saturation);
int CAMMode(int mode);

/* Image processing */
int IPLaplace(image* source, image* destination);
int IPSobel(image* source, image* destination);
int IPDither(image* source, image* destination);
int IPDiffer(image* current, image* last, image* destination);
int IPColor2Grey(colimage* source, image* destination);

/* Screen: 128 x 64 pixels, 16 x 7 characters above the menu */
int LCDInit(void); /* of older releases: no effect */
int LCDRelease(void);
int LCDPrintf(const char* format, ...) ROBIOS_PRINTF(1, 2);
int LCDSetPrintf(int row, int column, const char* format, ...) ROBIOS_PRINTF(3, 4);
int LCDClear(void);
int LCDPutChar(char character);
int LCDSetChar(int row, int column, char character);
int LCDPutString(const char* text);
int LCDSetString(int row, int column, const char* text);
int LCDPutHex(int value);
int LCDPutHex1(int value);
int LCDPutInt(int value);
int LCDPutIntS(int value, int spaces);
int LCDPutFloat(float value);
int LCDPutFloatS(float value, int spaces, int decimals);
int LCDMode(int mode);
int LCDSetPos(int row, int column);
int LCDGetPos(int* row, int* column);
int LCDPutGraphic(image* buffer);
int LCDPutColorGraphic(colimage* buffer);
int LCDPutImage(BYTE* buffer);
int LCDMenu(const char* key1, const char* key2, const char* key3, const char* key4);
int LCDMenuI(int position, const char* label);
int LCDSetPixel(int row, int column, int value);
int LCDInvertPixel(int row, int column);
int LCDGetPixel(int row, int column);
int LCDLine(int x1, int y1, int x2, int y2, int color);
int LCDArea(int x1, int y1, int x2, int y2, int color);

/* Keys */
int KEYGetBuf(char* buffer);
int KEYGet(void);
int KEYRead(void);
int KEYWait(int exit_code);

/* Tasks */
int OSMTInit(BYTE mode);
struct tcb* OSSpawn(const char* name, void (*code)(void), int stack_size, int priority, int uid);
int OSMTStatus(void);
int OSReady(struct tcb* thread);
int OSSuspend(struct tcb* thread);
int OSReschedule(void);
int OSYield(void);
int OSRun(struct tcb* thread);
int OSGetUID(struct tcb* thread);
int OSKill(struct tcb* thread);
int OSExit(int code);
int OSPanic(const char* message);
int OSSleep(int n);
int OSForbid(void);
int OSPermit(void);
int OSSemInit(struct sem* semaphore, int value);
int OSSemP(struct sem* semaphore);
int OSSemV(struct sem* semaphore);

/* Time */
TimerHandle OSAttachTimer(int scale, TimerFnc function);
int OSDetachTimer(TimerHandle handle);
int OSSetTime(int hours, int minutes, int seconds);
int OSGetTime(int* hours, int* minutes, int* seconds, int* ticks);
int OSShowTime(void);
int OSGetCount(void); /* 1/100 s since the program's start */
int OSWait(int n);    /* 1/100 s */

/* System */
char* OSVersion(void);
int OSError(const char* message, int number, BOOL dead);
int OSMachineID(void);
char* OSMachineName(void);
int OSMachineType(void);
int OSMachineSpeed(void);
int OSInfoCPU(int* speed, int* memory, int* free_memory);
int OSGetAD(int channel);
BYTE OSReadInLatch(int latch);
BYTE OSWriteOutLatch(int latch, BYTE mask, BYTE value);
BYTE OSReadOutLatch(int latch);

/* Radio */
int RADIOInit(void);
int RADIOTerm(void);
int RADIOSend(BYTE id, int byteCount, BYTE* buffer);
int RADIOCheck(void);
int RADIORecv(BYTE* id, int* byteCount, BYTE* buffer);
int RADIOGetIoctl(RadioIOParameters* parameters);
int RADIOSetIoctl(RadioIOParameters* parameters);
int RADIOGetStatus(RadioStatus* status);

/* Motors, encoders, servos */
MotorHandle MOTORInit(DeviceSemantics semantics);
int MOTORDrive(MotorHandle handle, int speed);
int MOTORRelease(MotorHandle handle);
QuadHandle QUADInit(DeviceSemantics semantics);
int QUADRead(QuadHandle handle);
int QUADReset(QuadHandle handle);
int QUADRelease(QuadHandle handle);
DeviceSemantics QUADGetMotor(DeviceSemantics semantics);
float QUADODORead(QuadHandle handle);
int QUADODOReset(QuadHandle handle);
ServoHandle SERVOInit(DeviceSemantics semantics);
int SERVOSet(ServoHandle handle, int angle);
int SERVORelease(ServoHandle handle);

/* Audio */
int AUPlaySample(char* sample);
int AUCheckSample(void);
int AUTone(int frequency, int milliseconds);
int AUCheckTone(void);
int AUBeep(void);
int AURecordSample(BYTE* buffer, long length, long frequency);
int AUCheckRecord(void);
int AUCaptureMic(long frequency);

/* Bumpers, infrared switches, compass */
BumpHandle BUMPInit(DeviceSemantics semantics);
int BUMPCheck(BumpHandle handle, int* timestamp);
int BUMPRelease(BumpHandle handle);
IRHandle IRInit(DeviceSemantics semantics);
int IRRead(IRHandle handle);
int IRRelease(IRHandle handle);
int COMPASSInit(DeviceSemantics semantics);
int COMPASSStart(BOOL cycle);
int COMPASSCheck(void);
int COMPASSStop(void);
int COMPASSRelease(void);
int COMPASSGet(void);
int COMPASSCalibrate(int mode);

/* Infrared remote control and serial lines: none is there */
int IRTVInit(int type, int length, int toggle_mask, int invert_mask, int mode, int buffer_size, int delay);
int IRTVInitHDT(DeviceSemantics semantics);
int IRTVGet(void);
int IRTVRead(void);
int IRTVPressed(void);
void IRTVFlush(void);
void IRTVTerm(void);
int OSInitRS232(int baud, int handshake, int interface);
int OSSendCharRS232(char character, int interface);
int OSSendRS232(char* character, int interface);
int OSRecvRS232(char* character, int interface);
int OSFlushInRS232(int interface);
int OSFlushOutRS232(int interface);
int OSCheckInRS232(int interface);
int OSCheckOutRS232(int interface);

/* Supervisor of the simulation [mm, degrees], as in RoBIOS-7 */
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
#endif
#endif
