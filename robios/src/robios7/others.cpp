#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstring>
#include <vector>

#include "../clocks.h"
#include "../functions.h"

using namespace robios;

namespace {

std::array<char, 16> directions{
    {'i', 'i', 'i', 'i', 'i', 'i', 'i', 'i', 'o', 'o', 'o', 'o', 'o', 'o', 'o', 'o'}};
unsigned outputs = 0;
std::vector<BYTE>& record() {
  static auto* const values = new std::vector<BYTE>;
  return *values;
}

bool is_line(int io) { return io >= 1 && io <= 16; }
bool is_output(int io) { return directions[static_cast<std::size_t>(io - 1)] == 'o'; }
int line(int io) {
  if (is_output(io)) return static_cast<int>(outputs >> (io - 1) & 1);
  const bool there = io <= static_cast<int>(std::min<std::size_t>(machine.robot().bumpers, most_bumpers));
  return there && machine.senses().bumper[io - 1] ? 1 : 0;
}

int converter(int channel) { return channel == 0 ? battery_level() : 0; }

int check(int* from) {
  if (!machine.robot().has_radio) return -1;
  if (machine.messages.empty()) return 0;
  set(from, static_cast<int>(machine.messages.front().from));
  return 1;
}

}  // namespace

extern "C" {

// Radio

int RADIORelease() {
  enter(Call::RADIORelease);
  return end_radio();
}
int RADIOGetID() {
  enter(Call::RADIOGetID);
  return static_cast<int>(machine.robot().id);
}
int RADIOSend(int id, const char* text) {
  enter(Call::RADIOSend);
  if (!text || id < 0) return failed;
  const std::size_t size = strnlen(text, most_radio_bytes);
  if (size >= most_radio_bytes) return failed;
  return send_message(static_cast<std::uint32_t>(id), text, size) ? ok : failed;
}
int RADIOReceive(int* id, char* buffer, int size) {
  enter(Call::RADIOReceive);
  if (!buffer || size < 1 || !machine.robot().has_radio) return failed;
  const Message message = await_message();
  const std::size_t taken = std::min(message.bytes.size(), static_cast<std::size_t>(size) - 1);
  std::copy_n(message.bytes.begin(), taken, buffer);
  buffer[taken] = '\0';
  set(id, static_cast<int>(message.from));
  return ok;
}
int RADIOCheckAny() {
  enter(Call::RADIOCheck);
  return check(nullptr);
}
/// Of programs that bring their own prototype.
#undef RADIOCheck
[[gnu::visibility("default")]] int robios_check() __asm__("RADIOCheck");
int robios_check() { return RADIOCheckAny(); }
int RADIOCheckID(int* id) {
  enter(Call::RADIOCheck);
  return check(id);
}
int RADIOStatus(int ids[]) {
  enter(Call::RADIOStatus);
  if (!machine.robot().has_radio) return 0;
  const std::size_t peers = std::min<std::size_t>(machine.senses().peers, most_peers - 1);
  if (ids) {
    ids[0] = static_cast<int>(machine.robot().id);
    for (std::size_t i = 0; i < peers; i++) ids[i + 1] = static_cast<int>(machine.senses().peer[i]);
  }
  return static_cast<int>(peers) + 1;
}

// Sound

int AUPlay(const char* file) {
  enter(Call::AUPlay);
  if (!file || !*file) return failed;
  play(0, 1, file);
  return ok;
}
int AUDone() {
  enter(Call::AUDone);
  return silent() ? 1 : 0;
}
int AUMicrophone() {
  enter(Call::AUMicrophone);
  return 0;
}

// Inputs and outputs

int DIGITALSetup(int io, char direction) {
  enter(Call::DIGITALSetup);
  if (!is_line(io) || !std::strchr("ioIJ", direction) || direction == '\0') return failed;
  directions[static_cast<std::size_t>(io - 1)] = direction;
  return ok;
}
int DIGITALRead(int io) {
  enter(Call::DIGITALRead);
  return is_line(io) ? line(io) : 0;
}
int DIGITALReadAll() {
  enter(Call::DIGITALReadAll);
  int all = 0;
  for (int io = 1; io <= 16; io++) all |= line(io) << (io - 1);
  return all;
}
int DIGITALWrite(int io, int state) {
  enter(Call::DIGITALWrite);
  if (!is_line(io) || !is_output(io)) return failed;
  outputs = (outputs & ~(1u << (io - 1))) | (state ? 1u << (io - 1) : 0);
  return ok;
}
int ANALOGRead(int channel) {
  enter(Call::ANALOGRead);
  return converter(channel);
}
int ANALOGVoltage() {
  enter(Call::ANALOGVoltage);
  return to_int(battery_V() * 100);
}
int ANALOGRecord(int channel, int iterations) {
  enter(Call::ANALOGRecord);
  if (channel < 0 || channel > 8 || iterations < 1 || iterations > 8192) return failed;
  record().assign(static_cast<std::size_t>(iterations), static_cast<BYTE>(converter(channel) >> 2));
  return ok;
}
int ANALOGTransfer(BYTE* buffer) {
  enter(Call::ANALOGTransfer);
  if (!buffer) return 0;
  std::copy(record().begin(), record().end(), buffer);
  return static_cast<int>(record().size());
}

// What the robot has not

int IRTVFlush() {
  enter(Call::IRTVFlush);
  return ok;
}
int IRTVGetStatus() {
  enter(Call::IRTVGetStatus);
  return 1;
}

int SERInit(int, int, int) {
  enter(Call::SERInit);
  return failed;
}
int SERSendChar(int, char) {
  enter(Call::SERSendChar);
  return failed;
}
int SERSend(int, const char*, ...) {
  enter(Call::SERSend);
  return failed;
}
char SERReceiveChar(int) {
  enter(Call::SERReceiveChar);
  return 0;
}
int SERReceive(int, void*, ...) {
  enter(Call::SERReceive);
  return 0;
}
bool SERCheck(int) {
  enter(Call::SERCheck);
  return false;
}
int SERFlush(int) {
  enter(Call::SERFlush);
  return failed;
}
int SERClose(int) {
  enter(Call::SERClose);
  return failed;
}

}  // extern "C"
