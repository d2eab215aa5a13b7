#include <algorithm>
#include <cstring>

#include "../clocks.h"
#include "api.h"

using namespace robios;

namespace {

RadioIOParameters parameters{SERIAL2, SER38400, 0, 0, 0, 0};
std::int64_t recorded_ns = 0;

}  // namespace

extern "C" {

// Radio

int RADIOTerm() {
  enter(Call::RADIOTerm);
  return end_radio();
}
int RADIOSend(BYTE id, int byteCount, BYTE* buffer) {
  enter(Call::RADIOSend);
  if (!radio_on || !buffer || byteCount < 0 || byteCount > MAXMSGLEN) return failed;
  return send_message(id, buffer, static_cast<std::size_t>(byteCount)) ? ok : failed;
}
int RADIOCheck() {
  enter(Call::RADIOCheck);
  return static_cast<int>(machine.messages.size());
}
int RADIORecv(BYTE* id, int* byteCount, BYTE* buffer) {
  enter(Call::RADIORecv);
  if (!radio_on || !buffer) return failed;
  const Message message = await_message();
  const std::size_t size = std::min<std::size_t>(message.bytes.size(), MAXMSGLEN);
  std::copy_n(message.bytes.begin(), size, buffer);
  set(id, static_cast<BYTE>(message.from));
  set(byteCount, static_cast<int>(size));
  return ok;
}
int RADIOGetIoctl(RadioIOParameters* to) {
  enter(Call::RADIOGetIoctl);
  if (!to) return failed;
  parameters.id = static_cast<int>(machine.robot().id);
  *to = parameters;
  return ok;
}
int RADIOSetIoctl(RadioIOParameters* from) {
  enter(Call::RADIOSetIoctl);
  if (!from) return failed;
  parameters = *from;
  return ok;
}
int RADIOGetStatus(RadioStatus* status) {
  enter(Call::RADIOGetStatus);
  if (!status || !machine.robot().has_radio) return failed;
  *status = {};
  constexpr std::size_t most = std::size(RadioStatus{}.active);
  const Senses& s = machine.senses();
  const auto mark = [&](std::uint32_t id) {
    if (id < most) status->active[id] = 1;
    if (status->master == 0 || static_cast<int>(id) < status->master) status->master = static_cast<int>(id);
  };
  mark(machine.robot().id);
  for (std::size_t i = 0; i < std::min<std::size_t>(s.peers, most_peers); i++) mark(s.peer[i]);
  return ok;
}

// Sound

int AUPlaySample(char* sample) {
  enter(Call::AUPlaySample);
  play(0, 1, sample ? "sample" : "");
  return 4000;
}
int AUCheckSample() {
  enter(Call::AUCheckSample);
  return silent() ? 1 : 0;
}
int AUTone(int frequency, int milliseconds) {
  enter(Call::AUTone);
  if (frequency < 1 || frequency > 65'000 || milliseconds < 1) return failed;
  play(frequency, milliseconds * 1e-3, "");
  return ok;
}
int AUCheckTone() {
  enter(Call::AUCheckTone);
  return silent() ? 1 : 0;
}
int AURecordSample(BYTE* buffer, long length, long frequency) {
  enter(Call::AURecordSample);
  if (!buffer || length < 1 || frequency < 1) return 0;
  std::memset(buffer, 128, static_cast<std::size_t>(length));
  recorded_ns = after(static_cast<std::int64_t>(
      std::min(static_cast<double>(length) / static_cast<double>(frequency), 1e6) * 1e9));
  return static_cast<int>(std::min(frequency, 65'000L));
}
int AUCheckRecord() {
  enter(Call::AUCheckRecord);
  return machine.clock_ns >= recorded_ns ? 1 : 0;
}
int AUCaptureMic(long) {
  enter(Call::AUCaptureMic);
  return 0;
}

// What the robot has not

int IRTVInit(int, int, int, int, int, int, int) {
  enter(Call::IRTVInit);
  return failed;
}
int IRTVInitHDT(DeviceSemantics) {
  enter(Call::IRTVInitHDT);
  return failed;
}
int IRTVPressed() {
  enter(Call::IRTVPressed);
  return 0;
}
void IRTVFlush() { enter(Call::IRTVFlush); }
void IRTVTerm() { enter(Call::IRTVTerm); }

int OSInitRS232(int, int, int) {
  enter(Call::OSInitRS232);
  return failed;
}
int OSSendCharRS232(char, int) {
  enter(Call::OSSendCharRS232);
  return failed;
}
int OSSendRS232(char*, int) {
  enter(Call::OSSendRS232);
  return failed;
}
int OSRecvRS232(char*, int) {
  enter(Call::OSRecvRS232);
  return failed;
}
int OSFlushInRS232(int) {
  enter(Call::OSFlushInRS232);
  return failed;
}
int OSFlushOutRS232(int) {
  enter(Call::OSFlushOutRS232);
  return failed;
}
int OSCheckInRS232(int) {
  enter(Call::OSCheckInRS232);
  return 0;
}
int OSCheckOutRS232(int) {
  enter(Call::OSCheckOutRS232);
  return 0;
}

}  // extern "C"
