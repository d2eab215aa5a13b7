#pragma once
/// Protocols of the middle-size league's referee box: bytes <-> words and world states. No sockets.
///
/// Commands    of the box to base stations: single bytes since 2009, JSON objects ending in a NUL since 2020. docs/referee_box.md.
/// World states  of base stations to the box: JSON objects ending in a NUL, with either protocol.
/// Errors      a sentence that names what is wrong in a message and what would be right. Bounded by the limits below, whatever the bytes.
/// Source      RoboCup-MSL/RefBox (mslrb2015) and the command bytes of the league's base stations; facts proven with other clients.
/// Not read    messages of team mates (mixed-team protocol), the score feed of port 12345.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace sandlot::refbox {

/// The port at which base stations look for a box.
inline constexpr std::uint16_t league_port = 28097;
/// Bytes that may come without a NUL, as in the league's box.
inline constexpr std::size_t most_bytes = 100'000;
/// Entries of a list in a world state.
inline constexpr std::size_t most_entries = 64;
inline constexpr std::int32_t most_robot = 99;

enum class Protocol : std::uint8_t { bytes_2009, json };
const char* name_of(Protocol protocol);

/// Whom a word is for.
enum class Side : std::uint8_t { both, cyan, magenta };
/// "", "cyan", "magenta".
const char* name_of(Side side);
/// Errors: a team of another name.
Result<Side> side_of(std::string_view team);

/// A word of the referee, such as KICKOFF for cyan.
struct Word {
  std::string command;
  Side side = Side::both;
  std::int32_t robot = 0;  ///< number of the robot that it is about; 0: none
  bool operator==(const Word&) const = default;
};

/// What the league knows of a word.
struct WordInfo {
  std::string_view command;
  char cyan = 0;             ///< byte of 2009 for cyan, or for both teams; 0: the bytes do not have it
  char magenta = 0;          ///< 0: the word is for both teams
  bool names_robot = false;  ///< in JSON it comes with the number of a robot
  bool of_team = false;      ///< it is said of one team
};
std::span<const WordInfo> words();
/// Null: the league has no such word.
const WordInfo* find_word(std::string_view command);

/// The byte of 2009. Errors: a word that the league does not have, or that has no byte; a word of a team for both.
Result<char> byte_of(const Word& word);
/// Nothing: no word has this byte.
std::optional<Word> word_of(char byte);

/// Multicast addresses by which JSON names the teams.
struct TeamIds {
  std::string cyan = "224.16.32.1", magenta = "224.16.32.2";
};

/// The JSON object with its NUL. Errors: as byte_of(), but for words without a byte.
Result<std::string> json_of(const Word& word, const TeamIds& ids);
/// @param text  without the NUL. Errors: no JSON object, keys missing, another word or target
Result<Word> read_json(std::string_view text, const TeamIds& ids);

/// A word as the bytes of a protocol.
Result<std::string> encode(const Word& word, Protocol protocol, const TeamIds& ids);

/// What a team believes of a robot of its own. Frame of the league: x to the right, y towards the opponents' goal.
struct RobotReport {
  std::int32_t id = 0;
  std::array<double, 3> pose{};      ///< [m, m, rad]
  std::array<double, 3> velocity{};  ///< [m/s, m/s, rad/s]
  bool ball_engaged = false;
};
struct PointReport {
  std::array<double, 3> position{};  ///< [m]
};
/// What a team believes of the world, for the log of the box.
struct WorldState {
  std::string team, intention;
  std::int32_t age_ms = 0;
  std::vector<RobotReport> robots;
  std::vector<PointReport> balls, obstacles;
};
/// Reads a message of a base station. The seven keys that the league's box asks for must be there, of its types; other keys are
/// passed over. Poses, velocities and positions are lists of at most three finite numbers.
/// @param text  without the NUL
Result<WorldState> read_world_state(std::string_view text);

/// Messages in a stream of bytes, each ending in a NUL; empty ones are passed over.
class MessageStream {
 public:
  void append(std::string_view bytes) { buffer_.append(bytes); }
  /// The next whole message, valid until the next call. Nothing: it is not complete yet.
  /// Errors: more than most_bytes without a NUL.
  Result<std::optional<std::string_view>> next();
  std::size_t waiting() const { return buffer_.size() - taken_; }

 private:
  std::string buffer_;
  std::size_t taken_ = 0, searched_ = 0;
};

}  // namespace sandlot::refbox
