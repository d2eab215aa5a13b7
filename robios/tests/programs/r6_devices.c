#include "eyebot.h"

#include "check.h"

int main() {
  PSDHandle front, left;
  MotorHandle ml, mr;
  QuadHandle ql;
  ServoHandle s1, s11;
  BumpHandle bump;
  IRHandle ir;
  int t = 0;
  front = PSDInit(PSD_FRONT);
  left = PSDInit(PSD_LEFT);
  CHECK(front != 0 && left != 0 && (front & left) == 0);
  EQUAL(PSDInit(PSD_DOWN), 0);
  EQUAL(PSDCheck(), 0);
  EQUAL(PSDStart(64, TRUE), -1);
  EQUAL(PSDStart(front | left, FALSE), 0);
  EQUAL(PSDStart(front, TRUE), 1); /* busy */
  EQUAL(PSDCheck(), 0);
  EQUAL(PSDGet(front), 0);         /* not ready */
  OSWait(10);
  EQUAL(PSDCheck(), 1);
  EQUAL(PSDGet(front), 100);
  EQUAL(PSDGet(left), 200);
  EQUAL(PSDStart(front | left, TRUE), 0);
  EQUAL(PSDGetRaw(front), 455);
  EQUAL(PSDGet(64), PSD_OUT_OF_RANGE);
  EQUAL(PSDStop(), 0);
  EQUAL(PSDCheck(), 0);
  EQUAL(PSDRelease(), 0);
  EQUAL(PSDGet(front), PSD_OUT_OF_RANGE);
  front = PSDInit(PSD_FRONT);
  EQUAL(PSDStart(front, TRUE), 0);
  OSWait(10);
  EQUAL(PSDCheck(), 1);
  PSDRelease(); /* ends repeated measurements */
  PSDInit(PSD_FRONT);
  EQUAL(PSDCheck(), 0);

  ml = MOTORInit(MOTOR_LEFT);
  mr = MOTORInit(MOTOR_RIGHT);
  CHECK(ml != 0 && mr != 0 && ml != mr);
  EQUAL(MOTORInit(MOTOR_FRONT), 0);
  EQUAL(MOTORDrive(ml, 100), 0);
  EQUAL(MOTORDrive(mr, -50), 0);
  EQUAL(MOTORDrive(mr, -101), -1);
  EQUAL(MOTORDrive(9, 50), -1);
  ql = QUADInit(QUAD_LEFT);
  CHECK(ql != 0);
  EQUAL(QUADInit(QUAD_BACK), 0);
  OSWait(54); /* 1000 ticks/s */
  CHECK(QUADRead(ql) >= 500 && QUADRead(ql) <= 600);
  NEAR(QUADODORead(ql), QUADRead(ql) / 540.0 * M_PI * 0.05, 1e-5);
  EQUAL(QUADReset(ql), 0);
  EQUAL(QUADRead(ql), 0);
  CHECK(QUADODORead(ql) > 0.1);
  EQUAL(QUADODOReset(ql), 0);
  EQUAL(QUADODORead(ql), 0);
  EQUAL(QUADGetMotor(QUAD_LEFT), MOTOR_LEFT);
  EQUAL(QUADGetMotor(PSD_LEFT), 0);
  EQUAL(QUADRelease(ql), 0);
  EQUAL(QUADRelease(ql), -1);
  EQUAL(QUADReset(ql), -1);
  EQUAL(MOTORRelease(ml), 0);
  EQUAL(MOTORRelease(ml), -1);

  s1 = SERVOInit(SERVO1);
  s11 = SERVOInit(SERVO11);
  CHECK(s1 != 0 && s11 != 0 && s1 != s11);
  EQUAL(SERVOInit(SERVO9), 0);
  EQUAL(SERVOSet(s1, 51), 0);
  EQUAL(SERVOSet(s11, 255), 0);
  EQUAL(SERVOSet(s1, 256), -1);
  EQUAL(SERVORelease(s1), 0);
  EQUAL(SERVOSet(s1, 0), -1);

  bump = BUMPInit(BUMP_RIGHT);
  CHECK(bump != 0);
  EQUAL(BUMPInit(BUMP_BACK), 0);
  EQUAL(BUMPCheck(bump, &t), 0);
  NEAR(t, OSGetCount(), 5); /* 1/100 s, of the slot's beginning */
  EQUAL(BUMPCheck(BUMPInit(BUMP_LEFT), &t), -1);
  EQUAL(BUMPRelease(bump), 0);
  EQUAL(BUMPCheck(bump, &t), -1);
  ir = IRInit(IR_LF);
  CHECK(ir != 0);
  EQUAL(IRInit(IR_RB), 0);
  EQUAL(IRRead(ir), 1);
  EQUAL(IRRelease(ir), 0);
  EQUAL(IRRead(ir), -1);

  EQUAL(COMPASSStart(TRUE), 1);
  EQUAL(COMPASSInit(COMPASS), 0);
  EQUAL(COMPASSCheck(), 0);
  EQUAL(COMPASSGet(), -1);
  EQUAL(COMPASSStart(TRUE), 0);
  EQUAL(COMPASSCheck(), 1);
  EQUAL(COMPASSGet(), 270); /* 90 degrees counter-clockwise */
  EQUAL(COMPASSCalibrate(1), 0);
  EQUAL(COMPASSStop(), 0);
  EQUAL(COMPASSRelease(), 0);
  EQUAL(COMPASSRelease(), 1);
  return failures;
}
