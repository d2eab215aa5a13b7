/// Files written, read, cut, damaged and repaired. What every byte must be is computed by hand for a tiny file;
/// tests/js reads ours with an independent library.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "base/hash.h"
#include "base/test_folder.h"
#include "record/mcap/repair.h"
#include "record/mcap/writer.h"

namespace sandlot::mcap {
namespace {

using testing::HasSubstr;

class Mcap : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_.file(name); }
  static std::string bytes_of(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string leave(const std::string& name, const std::string& bytes) const {
    return folder_.write(name, bytes);
  }
  /// In memory where there is such a folder: thousands of repairs each wait for the disk.
  static std::filesystem::path parent() {
    const std::filesystem::path memory = "/dev/shm";
    return std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
  }
  const test::TestFolder folder_{parent()};
};

std::span<const std::byte> bytes(std::string_view text) { return std::as_bytes(std::span(text)); }
std::string text(std::span<const std::byte> data) {
  return {reinterpret_cast<const char*>(data.data()), data.size()};
}

/// "topic time sequence data" of every message that a query gives.
Result<std::vector<std::string>> listing(const std::string& path, Query query = {}, Limits limits = {}) {
  SL_ASSIGN(const Reader reader, Reader::open(path, limits));
  Cursor cursor = reader.messages(std::move(query));
  std::vector<std::string> out;
  for (;;) {
    SL_ASSIGN(const Message* const m, cursor.next());
    if (!m) return out;
    out.push_back(m->channel->topic + " " + std::to_string(m->log_time) + " " + std::to_string(m->sequence) +
                  " " + text(m->data).substr(0, 20));
  }
}

/// What examine() complains about, "" for a whole file.
std::string trouble_of(const std::string& path) {
  const auto examined = examine(path);
  if (!examined) return examined.error().text();
  if (!examined->damages.empty()) return examined->damages.front().what;
  return examined->summary_trouble ? examined->summary_trouble->text() : "";
}

/// 40 messages on two topics, a chunk per four or five, an attachment and metadata in between.
void write_sample(const std::string& path, Compression compression, std::uint64_t chunk_bytes = 400) {
  auto writer = Writer::create(path, {.compression = compression, .chunk_bytes = chunk_bytes});
  ASSERT_TRUE(writer) << writer.error().text();
  const auto schema = writer->add_schema("pkg/msg/A", "ros2msg", "float64 data");
  const auto a = writer->add_channel(schema, "/a", "cdr", {{"offered_qos_profiles", ""}});
  const auto b = writer->add_channel(0, "/b", "json");
  for (std::uint64_t i = 0; i < 40; ++i) {
    if (i == 7) {
      ASSERT_TRUE(writer->attach("snapshot", "application/octet-stream", 70, bytes("all of it")));
    }
    if (i == 9) { ASSERT_TRUE(writer->add_metadata("sandlot", {{"seed", "5"}, {"version", "0.1"}})); }
    const std::string data = "message " + std::to_string(i) + std::string(60, 'x');
    ASSERT_TRUE(writer->write(i % 3 == 0 ? b : a, i * 10, bytes(data)));
  }
  const Status finished = writer->finish();
  ASSERT_TRUE(finished) << finished.error().text();
}

TEST(Crc, IsThatOfThePolynomialForAnyLengthAndInPieces) {
  std::vector<std::byte> bytes(700);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(mix64(i));
  std::uint32_t bit_by_bit = ~0u;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto part = std::span<const std::byte>(bytes).first(size);
    ASSERT_EQ(crc32(part), ~bit_by_bit) << size << " bytes";
    ASSERT_EQ(crc32(part.subspan(size / 3), crc32(part.first(size / 3))), ~bit_by_bit) << size << " bytes";
    bit_by_bit ^= std::to_integer<std::uint32_t>(bytes[size]);
    for (int bit = 0; bit < 8; ++bit) bit_by_bit = (bit_by_bit >> 1) ^ (bit_by_bit & 1 ? 0xedb88320u : 0);
  }
}

TEST_F(Mcap, ATinyFileHasTheBytesOfTheSpecification) {
  auto writer = Writer::create(file("t.mcap"), {.compression = Compression::none, .header = {"ros2", "me"}});
  ASSERT_TRUE(writer);
  const auto schema = writer->add_schema("S", "ros2msg", "x");
  const auto channel = writer->add_channel(schema, "/t", "cdr");
  ASSERT_TRUE(writer->write(channel, 5, bytes("ab")));
  ASSERT_TRUE(writer->finish());

  const auto le = [](std::uint64_t value, int size) {
    std::string out;
    for (int i = 0; i < size; ++i) out += static_cast<char>(value >> (8 * i));
    return out;
  };
  const auto str = [&](const std::string& s) { return le(s.size(), 4) + s; };
  const auto record = [&](int op, const std::string& content) {
    return std::string(1, static_cast<char>(op)) + le(content.size(), 8) + content;
  };
  // CRC-32 bit by bit, from its polynomial.
  const auto crc = [](const std::string& data) {
    std::uint32_t c = 0xffffffff;
    for (const char byte : data) {
      c ^= static_cast<unsigned char>(byte);
      for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
    }
    return c ^ 0xffffffff;
  };
  ASSERT_EQ(crc("123456789"), 0xcbf43926u);  // the check value that the polynomial is published with
  const std::string magic_text("\x89MCAP0\r\n", 8);
  const std::string schema_record = record(3, le(1, 2) + str("S") + str("ros2msg") + str("x"));
  const std::string channel_record = record(4, le(1, 2) + le(1, 2) + str("/t") + str("cdr") + le(0, 4));
  const std::string message_record = record(5, le(1, 2) + le(0, 4) + le(5, 8) + le(5, 8) + "ab");
  const std::string records = schema_record + channel_record + message_record;
  const std::string chunk = record(6, le(5, 8) + le(5, 8) + le(records.size(), 8) + le(crc(records), 4) +
                                          str("") + le(records.size(), 8) + records);
  const std::string index = record(
      7, le(1, 2) + le(16, 4) + le(5, 8) + le(schema_record.size() + channel_record.size(), 8));
  const std::string front = magic_text + record(1, str("ros2") + str("me"));
  const std::string data = front + chunk + index;
  const std::string data_end = record(15, le(crc(data), 4));
  const std::uint64_t summary_start = data.size() + data_end.size();
  const std::string statistics = record(0x0b, le(1, 8) + le(1, 2) + le(1, 4) + le(0, 4) + le(0, 4) +
                                                  le(1, 4) + le(5, 8) + le(5, 8) + le(10, 4) + le(1, 2) +
                                                  le(1, 8));
  const std::string chunk_index = record(8, le(5, 8) + le(5, 8) + le(front.size(), 8) + le(chunk.size(), 8) +
                                                le(10, 4) + le(1, 2) + le(front.size() + chunk.size(), 8) +
                                                le(index.size(), 8) + str("") + le(records.size(), 8) +
                                                le(records.size(), 8));
  std::string summary = schema_record + channel_record + statistics + chunk_index;
  const std::uint64_t offsets_start = summary_start + summary.size();
  std::uint64_t at = summary_start;
  for (const auto& [op, group] :
       {std::pair(3, schema_record), {4, channel_record}, {0x0b, statistics}, {8, chunk_index}}) {
    summary += record(0x0e, le(static_cast<std::uint64_t>(op), 1) + le(at, 8) + le(group.size(), 8));
    at += group.size();
  }
  const std::string covered = summary + "\x02" + le(20, 8) + le(summary_start, 8) + le(offsets_start, 8);
  EXPECT_EQ(bytes_of(file("t.mcap")), data + data_end + covered + le(crc(covered), 4) + magic_text);
}

class McapCompressed : public Mcap, public testing::WithParamInterface<Compression> {};
INSTANTIATE_TEST_SUITE_P(Each, McapCompressed,
                         testing::Values(Compression::none, Compression::lz4, Compression::zstd),
                         [](const auto& p) { return *file_name(p.param) ? file_name(p.param) : "none"; });

TEST_P(McapCompressed, WhatWasWrittenIsReadByTimeAndTopic) {
  write_sample(file("s.mcap"), GetParam());
  const auto all = listing(file("s.mcap"));
  ASSERT_TRUE(all) << all.error().text();
  ASSERT_EQ(all->size(), 40u);
  EXPECT_EQ(all->front(), "/b 0 0 message 0xxxxxxxxxxx");
  EXPECT_EQ(all->back(), "/b 390 13 message 39xxxxxxxxxx");
  // i = 10, 11, 13: those of topic a within [100, 130].
  const auto some = listing(file("s.mcap"), {.from = 100, .to = 130, .topics = {"/a"}});
  ASSERT_TRUE(some);
  EXPECT_EQ(*some, (std::vector<std::string>{"/a 100 6 message 10xxxxxxxxxx", "/a 110 7 message 11xxxxxxxxxx",
                                             "/a 130 8 message 13xxxxxxxxxx"}));
  const auto reader = Reader::open(file("s.mcap"));
  ASSERT_TRUE(reader);
  EXPECT_TRUE(reader->indexed());
  EXPECT_EQ(reader->header().profile, "ros2");
  EXPECT_EQ(text(*reader->attachment("snapshot")), "all of it");
  EXPECT_EQ(reader->metadata("sandlot")->at("seed"), "5");
  EXPECT_FALSE(reader->attachment("other"));
  const Statistics& s = reader->summary().statistics;
  EXPECT_EQ(s.message_count, 40u);
  EXPECT_EQ(s.channel_message_counts, (std::map<std::uint16_t, std::uint64_t>{{1, 26}, {2, 14}}));
  EXPECT_EQ(s.start_time, 0u);
  EXPECT_EQ(s.end_time, 390u);
  EXPECT_GT(s.chunk_count, 5u);
  const auto examined = examine(file("s.mcap"));
  ASSERT_TRUE(examined);
  EXPECT_TRUE(examined->whole());
  EXPECT_EQ(examined->found.statistics, s);
}

TEST_P(McapCompressed, CutAnywhereItReadsUpToThereAndRepairs) {
  write_sample(file("s.mcap"), GetParam());
  const std::string whole = bytes_of(file("s.mcap"));
  const auto all = listing(file("s.mcap"));
  const auto chunks = Reader::open(file("s.mcap"))->summary().chunks;
  const std::size_t header_end = 8 + 9 + 4 + 4 + 4 + 7;
  for (std::size_t size = 0; size < whole.size(); size += size < 60 ? 1 : 7) {
    const std::string path = leave("cut.mcap", whole.substr(0, size));
    const auto reader = Reader::open(path);
    const auto examined = examine(path);
    if (size < header_end) {
      EXPECT_FALSE(reader) << size;
      EXPECT_FALSE(examined) << size;
      continue;
    }
    ASSERT_TRUE(examined) << size;
    EXPECT_FALSE(examined->whole()) << size;
    // A chunk counts once its own record is complete, indexes or not.
    std::size_t complete = 0;
    for (const ChunkIndex& chunk : chunks) complete += chunk.offset + chunk.length <= size;
    const auto repaired = repair(path, *examined);
    ASSERT_TRUE(repaired) << size << repaired.error().text();
    EXPECT_EQ(repaired->kept_original, "") << size;
    const auto after = examine(path);
    ASSERT_EQ(trouble_of(path), "") << size;
    EXPECT_EQ(after->found.chunks.size(), complete) << size;
    const auto kept = listing(path);
    ASSERT_TRUE(kept) << size << kept.error().text();
    EXPECT_EQ(kept->size(), repaired->kept_messages) << size;
    EXPECT_TRUE(std::equal(kept->begin(), kept->end(), all->begin())) << size;
    // With all data there, the rebuilt file is the one that was written.
    if (complete == chunks.size()) { EXPECT_EQ(bytes_of(path), whole) << size; }
  }
}

TEST_P(McapCompressed, EveryFlippedBitIsNoticedAndCostsOneChunkAtMost) {
  write_sample(file("s.mcap"), GetParam());
  const std::string whole = bytes_of(file("s.mcap"));
  const auto all = listing(file("s.mcap"));
  for (std::size_t at = 0; at < whole.size(); at += 3) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 7)));
    const std::string path = leave("flip.mcap", damaged);
    const auto examined = examine(path);
    if (!examined) {
      EXPECT_LT(at, 40u) << examined.error().text();  // magic and header: nobody can tell what this is
      continue;
    }
    EXPECT_FALSE(examined->whole()) << at;
    const auto repaired = repair(path, *examined);
    ASSERT_TRUE(repaired) << at << repaired.error().text();
    ASSERT_EQ(trouble_of(path), "") << at;
    const auto kept = listing(path);
    ASSERT_TRUE(kept) << at;
    // The header's own length is the one thing that can hide more than a chunk.
    if (at > 40) { EXPECT_GE(kept->size() + 5, all->size()) << at; }
    if (repaired->lost_bytes > 0 && !repaired->before.damages.back().at_end) {
      EXPECT_EQ(bytes_of(repaired->kept_original), damaged) << at;
    }
  }
}

TEST_F(Mcap, ChunksThatOverlapInTimeAreMergedInOrder) {
  auto writer = Writer::create(file("o.mcap"), {.chunk_bytes = 1, .chunk_span_ns = UINT64_MAX});
  ASSERT_TRUE(writer);
  const auto channel = writer->add_channel(0, "/t", "json");
  for (const std::uint64_t time : {30u, 10u, 20u, 10u, 0u})
    ASSERT_TRUE(writer->write(channel, time, bytes("m")));
  ASSERT_TRUE(writer->finish());
  EXPECT_EQ(*listing(file("o.mcap")),
            (std::vector<std::string>{"/t 0 4 m", "/t 10 1 m", "/t 10 3 m", "/t 20 2 m", "/t 30 0 m"}));
  // All in one chunk: sorted within it.
  auto one = Writer::create(file("p.mcap"), {.chunk_span_ns = UINT64_MAX});
  ASSERT_TRUE(one);
  const auto channel_of_one = one->add_channel(0, "/t", "json");
  for (const std::uint64_t time : {30u, 10u, 20u}) ASSERT_TRUE(one->write(channel_of_one, time, bytes("m")));
  ASSERT_TRUE(one->finish());
  EXPECT_EQ(*listing(file("p.mcap")), (std::vector<std::string>{"/t 10 1 m", "/t 20 2 m", "/t 30 0 m"}));
  // More overlap than may be held at once is refused, not swallowed.
  auto wide = Writer::create(file("w.mcap"), {.chunk_bytes = 2000, .chunk_span_ns = UINT64_MAX});
  ASSERT_TRUE(wide);
  const auto channel_of_wide = wide->add_channel(0, "/t", "json");
  for (std::uint64_t i = 0; i < 10; ++i) {
    ASSERT_TRUE(wide->write(channel_of_wide, i, bytes("m")));
    ASSERT_TRUE(wide->write(channel_of_wide, 1000, bytes(std::string(2000, 'm'))));
  }
  ASSERT_TRUE(wide->finish());
  EXPECT_TRUE(listing(file("w.mcap")));
  const auto refused = listing(file("w.mcap"), {}, {.max_loaded = 10'000});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("overlap"));
}

TEST_F(Mcap, AChunkClosesAfterItsSpanOfTime) {
  auto writer = Writer::create(file("t.mcap"), {.chunk_bytes = 1 << 20, .chunk_span_ns = 100});
  ASSERT_TRUE(writer);
  const auto channel = writer->add_channel(0, "/t", "json");
  for (std::uint64_t i = 0; i <= 20; ++i) ASSERT_TRUE(writer->write(channel, 10 * i, bytes("m")));
  // 0..100 is one span, 110..200 spans 90 only and is still open.
  EXPECT_EQ(writer->summary().chunks.size(), 1u);
  EXPECT_GT(writer->bytes_pending(), 0u);
  ASSERT_TRUE(writer->finish());
  EXPECT_EQ(writer->summary().chunks.size(), 2u);
}

/// A file as another writer may leave it: no chunks, no summary.
std::string loose_file() {
  ByteWriter w;
  w.raw(magic.data(), magic.size());
  put_record(w, Op::header, Header{"", "somebody"});
  put_record(w, Op::schema, Schema{7, "S", "jsonschema", {}});
  put_record(w, Op::channel, Channel{3, 7, "/loose", "json", {}});
  for (std::uint64_t i = 0; i < 5; ++i) {
    put_record_of(w, Op::message, [&] {
      put(w, MessageHead{3, static_cast<std::uint32_t>(i), 50 - 10 * i, 0});
      w.raw("{}", 2);
    });
    if (i == 2) put_record_of(w, static_cast<Op>(0x90), [&] { w.raw("mine", 4); });  // somebody's own record
  }
  put_record(w, Op::data_end, std::uint32_t{0});
  put_record(w, Op::footer, Footer{});
  w.raw(magic.data(), magic.size());
  return text(w.bytes());
}

TEST_F(Mcap, AForeignFileWithoutChunksOrSummaryIsReadAndGetsThemByRepair) {
  const std::string path = leave("l.mcap", loose_file());
  const std::vector<std::string> expected{"/loose 10 4 {}", "/loose 20 3 {}", "/loose 30 2 {}",
                                          "/loose 40 1 {}", "/loose 50 0 {}"};
  const auto found = listing(path);
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_EQ(*found, expected);
  EXPECT_FALSE(Reader::open(path)->indexed());
  const auto examined = examine(path);
  ASSERT_TRUE(examined);
  EXPECT_EQ(examined->loose_messages, 5u);
  EXPECT_TRUE(examined->damages.empty());
  ASSERT_FALSE(examined->whole());
  EXPECT_THAT(examined->summary_trouble->what, HasSubstr("no summary"));
  const auto repaired = repair(path, *examined);
  ASSERT_TRUE(repaired) << repaired.error().text();
  EXPECT_EQ(trouble_of(path), "");
  EXPECT_TRUE(Reader::open(path)->indexed());
  EXPECT_EQ(*listing(path), expected);
}

TEST_F(Mcap, OtherFilesAndVersionsAreNamed) {
  const auto error_of = [&](const std::string& content) {
    const auto reader = Reader::open(leave("x.mcap", content));
    return reader ? std::string("read") : reader.error().text();
  };
  EXPECT_THAT(error_of(""), HasSubstr("not an MCAP recording"));
  EXPECT_THAT(error_of("#ROSBAG V2.0\n and so on"), HasSubstr("not an MCAP recording"));
  std::string newer = loose_file();
  newer[5] = '1';
  EXPECT_THAT(error_of(newer), HasSubstr("version '1'"));
  EXPECT_THAT(error_of(newer), HasSubstr("x.mcap"));
  EXPECT_FALSE(Reader::open(file("nowhere.mcap")));
  EXPECT_FALSE(Reader::open(folder_.path.string()));
  std::string unknown = loose_file();
  ByteWriter w;
  w.raw(unknown.data(), unknown.size() - 9 - 4 - 9 - 20 - 8);
  put_record_of(w, Op::chunk, [&] { put(w, ChunkHead{0, 0, 4, 0, "brotli", 4}), w.raw("abcd", 4); });
  EXPECT_THAT(examine(leave("b.mcap", text(w.bytes())))->damages.front().what,
              HasSubstr("'brotli' is not known"));
}

TEST_F(Mcap, AChunkThatPromisesTooMuchCostsNoMemory) {
  write_sample(file("s.mcap"), Compression::zstd);
  const auto refused = listing(file("s.mcap"), {}, {.max_chunk = 100});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("too large"));
  // 20 bytes that say they are 500 MB: what comes out is what is allocated.
  for (const Compression compression : {Compression::lz4, Compression::zstd}) {
    std::vector<std::byte> small, out;
    ASSERT_TRUE(Compressor(compression).compress(bytes("twenty bytes of text"), small));
    EXPECT_FALSE(decompress(file_name(compression), small, 500'000'000, out));
    EXPECT_LT(out.capacity(), 1u << 20);
    EXPECT_FALSE(decompress(file_name(compression), small, 19, out));
    EXPECT_FALSE(decompress(file_name(compression), std::span(small).first(small.size() - 1), 20, out));
    ASSERT_TRUE(decompress(file_name(compression), small, 20, out));
    EXPECT_EQ(text(out), "twenty bytes of text");
    small.push_back(std::byte{0});
    EXPECT_FALSE(decompress(file_name(compression), small, 20, out));
    // Zeros pack so well that the buffer has to grow several times.
    const std::vector<std::byte> zeros(3'000'000);
    std::vector<std::byte> packed;
    ASSERT_TRUE(Compressor(compression).compress(zeros, packed));
    ASSERT_TRUE(decompress(file_name(compression), packed, zeros.size(), out));
    EXPECT_EQ(out, zeros);
    EXPECT_FALSE(decompress(file_name(compression), packed, zeros.size() - 1, out));
    EXPECT_FALSE(decompress(file_name(compression), packed, zeros.size() + 1, out));
  }
}

TEST_F(Mcap, AFileThatIsBeingWrittenIsLeftAlone) {
  auto writer = Writer::create(file("w.mcap"), {});
  ASSERT_TRUE(writer);
  const auto examined = examine(file("w.mcap"));
  ASSERT_FALSE(examined);
  EXPECT_THAT(examined.error().what, HasSubstr("is being written"));
  EXPECT_THAT(Writer::create(file("w.mcap"), {}).error().what, HasSubstr("another program"));
  ASSERT_TRUE(writer->finish());
  EXPECT_TRUE(examine(file("w.mcap"))->whole());
}

TEST_F(Mcap, PlacesThatCannotBeWrittenSayWhy) {
  EXPECT_THAT(Writer::create(file("no/such/folder.mcap"), {}).error().what, HasSubstr("No such file"));
  EXPECT_THAT(Writer::create(folder_.path.string(), {}).error().what, HasSubstr("s a directory"));
  // The kernel's own full disk.
  const auto full = Writer::create("/dev/full", {});
  ASSERT_FALSE(full);
  EXPECT_THAT(full.error().what, HasSubstr("No space left"));
  ASSERT_EQ(mkfifo(file("pipe").c_str(), 0600), 0);
  EXPECT_THAT(Writer::create(file("pipe"), {}).error().text(), HasSubstr("nobody reads"));
}

TEST_F(Mcap, WhenTheDiskIsFullWhatWasWrittenStaysReadable) {
  // A limit on the size of files stands for the full disk: 8 kB, where the sample would take more.
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  auto writer = Writer::create(file("f.mcap"), {.compression = Compression::none, .chunk_bytes = 1000});
  ASSERT_TRUE(writer);
  const auto channel = writer->add_channel(0, "/t", "json");
  const rlimit small{8192, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  Status status;
  std::uint64_t written = 0;
  while (status && written < 1000)
    if ((status = writer->write(channel, written, bytes(std::string(100, 'x'))))) ++written;
  const Status again = writer->write(channel, written, bytes("x"));
  const Status finished = writer->finish();
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, HasSubstr("f.mcap"));
  EXPECT_THAT(status.error().what, HasSubstr("File too large"));
  EXPECT_FALSE(again);
  EXPECT_FALSE(finished);
  // 131 bytes of record per message: eight to a chunk of 1048 bytes + heads and index, so 6 chunks of 1.2 kB fit.
  auto examined = examine(file("f.mcap"));
  ASSERT_TRUE(examined) << examined.error().text();
  if (!examined->whole()) { ASSERT_TRUE(repair(file("f.mcap"), *examined)); }
  const auto kept = listing(file("f.mcap"));
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->size() % 8, 0u);
  EXPECT_GE(kept->size(), 40u);
  EXPECT_LE(kept->size(), written);
}

}  // namespace
}  // namespace sandlot::mcap
