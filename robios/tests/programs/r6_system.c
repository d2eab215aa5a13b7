#include "eyebot.h"

#include <string.h>

#include "check.h"

static int beats = 0;
static void beat(void) { beats++; }

int main() {
  char key = 0;
  BYTE buffer[64], id = 0;
  int h, m, s, ticks, start, count = 0, x, y, z;
  TimerHandle timer;
  RadioIOParameters io;
  RadioStatus status;

  EQUAL(KEYRead(), 0);
  EQUAL(KEYGet(), KEY2); /* at 1.0 s; then 3, 4 at 1.2 s; 1 at 1.7 s */
  NEAR(OSGetCount(), 100, 5);
  EQUAL(KEYWait(KEY4), KEY4);
  EQUAL(KEYGetBuf(&key), 0);
  EQUAL(key, KEY1);

  start = OSGetCount();
  EQUAL(OSWait(25), 0);
  NEAR(OSGetCount(), start + 25, 1);
  EQUAL(OSWait(-1), 1);
  EQUAL(OSSetTime(23, 59, 59), 0);
  OSWait(150);
  EQUAL(OSGetTime(&h, &m, &s, &ticks), 0);
  EQUAL(h * 3600 + m * 60 + s, 0);
  NEAR(ticks, 50, 1);
  EQUAL(OSSetTime(0, 60, 0), 1);
  LCDClear();
  EQUAL(OSShowTime(), 0);
  LCDPutChar('\n');
  timer = OSAttachTimer(10, beat); /* 10 Hz */
  CHECK(timer != 0);
  OSWait(105);
  EQUAL(beats, 10);
  EQUAL(OSDetachTimer(timer), 0);
  EQUAL(OSDetachTimer(timer), 1);

  CHECK(strstr(OSVersion(), "RoBIOS") != 0);
  EQUAL(OSError("careful", 5, FALSE), 0);
  EQUAL(OSMachineID(), 3);
  EQUAL(strcmp(OSMachineName(), "Eve"), 0);
  EQUAL(OSMachineType(), VEHICLE);
  EQUAL(OSMachineSpeed(), 35000000);
  EQUAL(OSInfoCPU(&x, &y, &z), 0);
  EQUAL(x, 35000000);
  EQUAL(OSGetAD(1), 682);
  EQUAL(OSGetAD(7), 0);
  EQUAL(OSReadInLatch(0), 2 + 4); /* the bumpers 2 and 3 are touched */
  EQUAL(OSReadInLatch(99), 0);
  EQUAL(OSWriteOutLatch(0, 0xFF, 0x0F), 0);
  EQUAL(OSWriteOutLatch(0, 0x0F, 0x03), 0x0F);
  EQUAL(OSReadOutLatch(0), 0x03);
  EQUAL(OSWriteOutLatch(0, 0x00, 0x05), 0x03);
  EQUAL(OSReadOutLatch(0), 0x06); /* what is not masked is inverted */
  EQUAL(OSReadOutLatch(-1), 0);

  EQUAL(RADIOSend(5, 3, buffer), 1); /* not initialised */
  EQUAL(RADIOInit(), 0);
  memcpy(buffer, "abc", 3);
  EQUAL(RADIOSend(5, 3, buffer), 0);
  EQUAL(RADIOSend(BROADCAST, 36, buffer), 1);
  EQUAL(RADIOCheck(), 0);
  printf("radio\n"); /* the fake sends "answer" and "second" one second later */
  EQUAL(RADIORecv(&id, &count, buffer), 0);
  EQUAL(id, 9);
  EQUAL(count, 6);
  EQUAL(memcmp(buffer, "answer", 6), 0);
  EQUAL(RADIOCheck(), 2);
  EQUAL(RADIOGetIoctl(&io), 0);
  EQUAL(io.id, 3);
  io.speed = SER9600;
  EQUAL(RADIOSetIoctl(&io), 0);
  io.speed = 0;
  RADIOGetIoctl(&io);
  EQUAL(io.speed, SER9600);
  EQUAL(RADIOGetStatus(&status), 0);
  EQUAL(status.active[3], 1);
  EQUAL(status.active[9], 1);
  EQUAL(status.active[4], 0);
  EQUAL(status.master, 3);
  EQUAL(RADIOTerm(), 0);
  EQUAL(RADIOTerm(), 1);
  EQUAL(RADIOCheck(), 0);

  EQUAL(AUBeep(), 0);
  EQUAL(AUCheckTone(), 0);
  OSWait(15);
  EQUAL(AUCheckTone(), 1);
  EQUAL(AUTone(440, 500), 0);
  EQUAL(AUTone(0, 500), 1);
  EQUAL(AUPlaySample((char *)"beep"), 4000);
  EQUAL(AUCheckSample(), 0);
  EQUAL(AURecordSample(buffer, 64, 128), 128);
  EQUAL(buffer[63], 128);
  EQUAL(AUCheckRecord(), 0);
  OSWait(40);
  EQUAL(AUCheckRecord(), 0); /* 64 samples take half a second */
  OSWait(20);
  EQUAL(AUCheckRecord(), 1);
  EQUAL(AUCaptureMic(100), 0);

  EQUAL(IRTVInit(1, 2, 3, 4, 5, 6, 7), 1);
  EQUAL(IRTVInitHDT(IRTV), 1);
  EQUAL(IRTVGet(), 0);
  EQUAL(IRTVRead(), 0);
  EQUAL(IRTVPressed(), 0);
  IRTVFlush();
  IRTVTerm();
  EQUAL(OSInitRS232(SER9600, NONE, SERIAL1), 1);
  EQUAL(OSSendCharRS232('x', SERIAL1), 1);
  EQUAL(OSSendRS232(&key, SERIAL1), 1);
  EQUAL(OSRecvRS232(&key, SERIAL1), 1);
  EQUAL(OSFlushInRS232(SERIAL1), 1);
  EQUAL(OSFlushOutRS232(SERIAL1), 1);
  EQUAL(OSCheckInRS232(SERIAL1), 0);
  EQUAL(OSCheckOutRS232(SERIAL1), 0);
  printf("%d\n", failures);
  OSError("end", 7, TRUE);
  return 99;
}
