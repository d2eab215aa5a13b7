/// Any bytes: the MCAP reader, the examination and the repair answer with errors, and what they make is whole.
#include <unistd.h>

#include "base/check.h"
#include "record/mcap/repair.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  constexpr mcap::Limits limits{
      .max_chunk = 1 << 20, .max_attachment = 1 << 20, .max_summary = 1 << 20, .max_loaded = 4 << 20};
  const std::string path = "/dev/shm/sandlot-mcap-fuzz-" + std::to_string(getpid());
  {
    auto file = mcap::OutputFile::create(path);
    SL_CHECK(file && file->write(std::as_bytes(std::span(data, size))) && file->close());
  }
  const auto count = [&]() -> std::uint64_t {
    const auto reader = mcap::Reader::open(path, limits);
    if (!reader) return 0;
    mcap::Cursor cursor = reader->messages({});
    std::uint64_t messages = 0, last = 0;
    for (;; ++messages) {
      const auto message = cursor.next();
      if (!message || !*message) return messages;
      SL_CHECK((*message)->log_time >= last);
      last = (*message)->log_time;
    }
  };
  count();
  auto examined = mcap::examine(path, limits);
  if (!examined) return 0;
  if (!examined->whole()) {
    const auto repaired = mcap::repair(path, *examined, limits);
    SL_CHECK(repaired);
    const auto after = mcap::examine(path, limits);
    SL_CHECK(after && after->whole());
    SL_CHECK(count() == repaired->kept_messages);
  }
  return 0;
}
