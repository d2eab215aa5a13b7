#include "eyebot.h"

#include <string.h>

#include "check.h"

static int beats = 0, quick = 0;
static void beat(void) { beats++; }
static void fast(void) { quick++; }

int main() {
  char text[1100], buffer[64];
  BYTE values[16];
  int x = 0, y = 0, h, m, s, ticks, id = 0, ids[256], start, i;
  TIMER timer, other;

  /* Keys at 1.0 s: 2, 1.2 s: 3, 4, 1.4 s: touch at 30, 40, then 1.6 s: touch of the fourth label. */
  EQUAL(KEYRead(), 0);
  EQUAL(KEYReadXY(&x, &y), 1);
  EQUAL(KEYGet(), KEY2);
  NEAR(OSGetCount(), 1000, 50);
  EQUAL(KEYWait(KEY4), KEY4); /* 3 is dropped */
  NEAR(OSGetCount(), 1200, 50);
  EQUAL(KEYGetXY(&x, &y), 0);
  EQUAL(x, 30);
  EQUAL(y, 40);
  NEAR(OSGetCount(), 1400, 50);
  EQUAL(KEYWait(ANYKEY), KEY4);
  EQUAL(KEYReadXY(&x, &y), 0);
  EQUAL(x, 310);
  EQUAL(KEYRead(), NOKEY);
  EQUAL(KEYWait(0), KEY1); /* any; at 1.7 s */

  start = OSGetCount();
  EQUAL(OSWait(250), 0);
  NEAR(OSGetCount() - start, 250, 1);
  EQUAL(OSWait(-1), 1);
  EQUAL(OSSetTime(23, 59, 59), 0);
  OSWait(1500);
  EQUAL(OSGetTime(&h, &m, &s, &ticks), 0);
  EQUAL(h, 0);
  EQUAL(m, 0);
  EQUAL(s, 0);
  NEAR(ticks, 500, 1);
  EQUAL(OSSetTime(24, 0, 0), 1);
  timer = OSAttachTimer(100, beat); /* 10 Hz */
  other = OSAttachTimer(20, fast);
  CHECK(timer != 0 && other != 0 && timer != other);
  OSWait(1050);
  EQUAL(beats, 10);
  EQUAL(quick, 52);
  EQUAL(OSDetachTimer(timer), 0);
  EQUAL(OSDetachTimer(timer), 1);
  EQUAL(OSDetachTimer(99), 1);
  OSWait(500);
  EQUAL(beats, 10);
  EQUAL(OSDetachTimer(other), 0);
  EQUAL(OSAttachTimer(0, beat), 0);
  /* At most 16 at a time. */
  for (i = 0; i < 16; i++) CHECK(OSAttachTimer(1000, beat) != 0);
  EQUAL(OSAttachTimer(1000, beat), 0);

  EQUAL(OSVersion(text), 0);
  CHECK(strstr(text, "RoBIOS") != 0);
  EQUAL(OSVersionIO(text), 0);
  CHECK(strstr(text, "RoBIOS") != 0);
  EQUAL(OSMachineSpeed(), 900);
  EQUAL(OSMachineType(), VEHICLE);
  EQUAL(OSMachineName(text), 0);
  EQUAL(strcmp(text, "Eve"), 0);
  EQUAL(OSMachineID(), 3);
  EQUAL(OSExecute("echo", text), 1);

  EQUAL(RADIOInit(), 0);
  EQUAL(RADIOGetID(), 3);
  EQUAL(RADIOSend(5, "hello"), 0);
  EQUAL(RADIOSend(0, "all"), 0);
  memset(text, 'x', 1099);
  text[1099] = 0;
  EQUAL(RADIOSend(5, text), 1); /* too long */
  EQUAL(RADIOSend(-1, "x"), 1);
  EQUAL(RADIOCheck(), 0);
  printf("radio\n"); /* the fake sends "answer" and "second" one second later */
  EQUAL(RADIOReceive(&id, buffer, 64), 0);
  EQUAL(id, 9);
  EQUAL(strcmp(buffer, "answer"), 0);
  id = 0;
  EQUAL(RADIOCheck(&id), 1);
  EQUAL(id, 8); /* not 5, who came later */
  buffer[4] = 'k';
  EQUAL(RADIOReceive(&id, buffer, 4), 0);
  EQUAL(strcmp(buffer, "sec"), 0);
  EQUAL(buffer[4], 'k');
  EQUAL(RADIOStatus(ids), 3);
  EQUAL(ids[0], 3);
  EQUAL(ids[1], 8);
  EQUAL(ids[2], 9);
  EQUAL(RADIORelease(), 0);
  EQUAL(RADIORelease(), 1);

  EQUAL(AUBeep(), 0);
  EQUAL(AUDone(), 0);
  OSWait(150);
  EQUAL(AUDone(), 1);
  EQUAL(AUPlay("song.wav"), 0);
  EQUAL(AUPlay(""), 1);
  EQUAL(AUMicrophone(), 0);

  EQUAL(DIGITALRead(1), 0);
  EQUAL(DIGITALRead(2), 1); /* the right bumper is touched */
  EQUAL(DIGITALRead(17), 0);
  EQUAL(DIGITALSetup(10, 'o'), 0);
  EQUAL(DIGITALSetup(10, 'x'), 1);
  EQUAL(DIGITALSetup(0, 'i'), 1);
  EQUAL(DIGITALWrite(10, 1), 0);
  EQUAL(DIGITALWrite(1, 1), 1);
  EQUAL(DIGITALRead(10), 1);
  EQUAL(DIGITALReadAll(), 2 + 512);
  EQUAL(ANALOGRead(0), 767); /* 9 V of 12 V */
  EQUAL(ANALOGRead(5), 0);
  EQUAL(ANALOGVoltage(), 900);
  EQUAL(ANALOGRecord(0, 4), 0);
  EQUAL(ANALOGRecord(9, 4), 1);
  EQUAL(ANALOGRecord(0, 100000), 1);
  EQUAL(ANALOGTransfer(values), 4);
  EQUAL(values[3], 191); /* the upper eight bits */

  EQUAL(IRTVGet(), 0);
  EQUAL(IRTVRead(), 0);
  EQUAL(IRTVFlush(), 0);
  EQUAL(IRTVGetStatus(), 1);
  EQUAL(SERInit(1, 9600, 0), 1);
  EQUAL(SERSendChar(1, 'x'), 1);
  EQUAL(SERSend(1, "text"), 1);
  EQUAL(SERReceiveChar(1), 0);
  EQUAL(SERReceive(1, buffer, 3), 0);
  EQUAL(SERCheck(1), 0);
  EQUAL(SERFlush(1), 1);
  EQUAL(SERClose(1), 1);
  return failures;
}
