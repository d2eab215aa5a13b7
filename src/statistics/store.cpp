#include "statistics/store.h"

#include <sqlite3.h>

#include <bit>
#include <utility>

namespace sandlot::statistics {
namespace {

constexpr int application_id = 0x534c5253;  // "SLRS"
constexpr int version = 1;

constexpr const char* schema = R"(
CREATE TABLE experiments(
  id INTEGER PRIMARY KEY,
  fingerprint TEXT NOT NULL UNIQUE,
  name TEXT NOT NULL,
  physics TEXT NOT NULL,
  settings TEXT NOT NULL);
CREATE TABLE runs(
  experiment INTEGER NOT NULL REFERENCES experiments(id),
  seed INTEGER NOT NULL,
  end_time REAL NOT NULL,
  stopped TEXT NOT NULL,
  state_hash TEXT NOT NULL,
  PRIMARY KEY(experiment, seed)) WITHOUT ROWID;
CREATE TABLE criteria(
  experiment INTEGER NOT NULL,
  seed INTEGER NOT NULL,
  team TEXT NOT NULL,
  value REAL,
  success INTEGER,
  PRIMARY KEY(experiment, seed, team)) WITHOUT ROWID;
)";

std::int64_t as_signed(std::uint64_t seed) { return std::bit_cast<std::int64_t>(seed); }

}  // namespace

struct ResultStore::Database {
  explicit Database(std::string name) : file(std::move(name)) {}
  ~Database() { sqlite3_close(handle); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  Error error() const {
    const int code = sqlite3_errcode(handle);
    if (code == SQLITE_NOTADB) return {"'" + file + "' is not a store of results", "name a new file"};
    return {"'" + file + "': " + sqlite3_errmsg(handle),
            code == SQLITE_BUSY ? "another process is writing it; try again" : ""};
  }
  Status execute(const char* sql) {
    return sqlite3_exec(handle, sql, nullptr, nullptr, nullptr) == SQLITE_OK ? Status() : error();
  }

  std::string file;
  sqlite3* handle = nullptr;
};

namespace {

/// One SQL statement with its parameters, from the first on.
class Statement {
 public:
  Statement(sqlite3* handle, const char* sql) { sqlite3_prepare_v2(handle, sql, -1, &statement_, nullptr); }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(std::int64_t x) { return sqlite3_bind_int64(statement_, ++bound_, x), *this; }
  Statement& bind(double x) { return sqlite3_bind_double(statement_, ++bound_, x), *this; }
  Statement& bind(const std::string& text) {
    sqlite3_bind_text(statement_, ++bound_, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
    return *this;
  }
  Statement& bind(std::optional<double> x) { return x ? bind(*x) : bind_null(); }
  Statement& bind(std::optional<bool> x) { return x ? bind(std::int64_t{*x}) : bind_null(); }
  Statement& bind_null() { return sqlite3_bind_null(statement_, ++bound_), *this; }

  /// SQLITE_ROW, SQLITE_DONE or an error.
  int step() { return statement_ ? sqlite3_step(statement_) : SQLITE_ERROR; }
  bool is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  double number(int column) const { return sqlite3_column_double(statement_, column); }
  std::string text(int column) const {
    const auto* const bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return bytes ? std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)))
                 : std::string();
  }

 private:
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

/// -1: it cannot be read.
std::int64_t pragma(sqlite3* handle, const char* sql) {
  Statement query(handle, sql);
  return query.step() == SQLITE_ROW ? query.integer(0) : -1;
}

}  // namespace

ResultStore::ResultStore(std::unique_ptr<Database> database) : database_(std::move(database)) {}
ResultStore::ResultStore(ResultStore&&) noexcept = default;
ResultStore& ResultStore::operator=(ResultStore&&) noexcept = default;
ResultStore::~ResultStore() = default;

Result<ResultStore> ResultStore::open(const std::string& file) {
  auto database = std::make_unique<Database>(file);
  if (sqlite3_open_v2(file.c_str(), &database->handle,
                      SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_FULLMUTEX,
                      nullptr) != SQLITE_OK)
    return Error{"'" + file + "' cannot be opened: " + sqlite3_errmsg(database->handle),
                 "name a file in a folder that can be written"};
  sqlite3* const handle = database->handle;
  sqlite3_busy_timeout(handle, 10'000);
  // From here on no other process changes what the file is.
  SL_TRY(database->execute("BEGIN IMMEDIATE"));
  const std::int64_t tables = pragma(handle, "SELECT count(*) FROM sqlite_master");
  const std::int64_t owner = pragma(handle, "PRAGMA application_id");
  if (tables < 0 || (tables > 0 && owner != application_id))
    return Error{"'" + file + "' is a database of another program", "name a new file"};
  if (tables > 0 && pragma(handle, "PRAGMA user_version") != version)
    return Error{"'" + file + "' is a store of results of another version of Sandlot", "name a new file"};
  if (tables == 0) {
    SL_TRY(database->execute(schema));
    SL_TRY(database->execute(("PRAGMA application_id = " + std::to_string(application_id)).c_str()));
    SL_TRY(database->execute(("PRAGMA user_version = " + std::to_string(version)).c_str()));
  }
  SL_TRY(database->execute("COMMIT"));
  return ResultStore(std::move(database));
}

Result<std::int64_t> ResultStore::experiment(const StoredExperiment& experiment) {
  sqlite3* const handle = database_->handle;
  Statement insert(handle,
                   "INSERT INTO experiments(fingerprint, name, physics, settings) VALUES(?, ?, ?, ?) "
                   "ON CONFLICT(fingerprint) DO NOTHING");
  insert.bind(experiment.fingerprint)
      .bind(experiment.name)
      .bind(experiment.physics)
      .bind(experiment.settings);
  if (insert.step() != SQLITE_DONE) return database_->error();
  Statement find(handle, "SELECT id FROM experiments WHERE fingerprint = ?");
  find.bind(experiment.fingerprint);
  if (find.step() != SQLITE_ROW) return database_->error();
  return find.integer(0);
}

Result<std::vector<StoredRun>> ResultStore::runs(std::int64_t experiment, std::uint64_t first,
                                                 std::uint64_t count) {
  std::vector<StoredRun> out;
  if (count == 0) return out;
  Statement query(
      database_->handle,
      "SELECT r.seed, r.end_time, r.stopped, r.state_hash, c.team, c.value, c.success FROM runs r "
      "LEFT JOIN criteria c ON c.experiment = r.experiment AND c.seed = r.seed "
      "WHERE r.experiment = ? AND r.seed BETWEEN ? AND ? ORDER BY r.seed, c.team");
  query.bind(experiment).bind(as_signed(first)).bind(as_signed(first + count - 1));
  int step = query.step();
  for (; step == SQLITE_ROW; step = query.step()) {
    const auto seed = std::bit_cast<std::uint64_t>(query.integer(0));
    if (out.empty() || out.back().seed != seed)
      out.push_back({seed, query.number(1), query.text(2), query.text(3), {}});
    if (query.is_null(4)) continue;
    StoredCriterion& criterion = out.back().criteria.emplace_back();
    criterion.team = query.text(4);
    if (!query.is_null(5)) criterion.value = query.number(5);
    if (!query.is_null(6)) criterion.success = query.integer(6) != 0;
  }
  if (step != SQLITE_DONE) return database_->error();
  return out;
}

Status ResultStore::add(std::int64_t experiment, const StoredRun& run) {
  sqlite3* const handle = database_->handle;
  const std::int64_t seed = as_signed(run.seed);
  const auto write = [&]() -> Status {
    Statement insert(handle, "INSERT OR REPLACE INTO runs VALUES(?, ?, ?, ?, ?)");
    insert.bind(experiment).bind(seed).bind(run.end_s).bind(run.stopped).bind(run.state_hash);
    if (insert.step() != SQLITE_DONE) return database_->error();
    Statement forget(handle, "DELETE FROM criteria WHERE experiment = ? AND seed = ?");
    forget.bind(experiment).bind(seed);
    if (forget.step() != SQLITE_DONE) return database_->error();
    for (const StoredCriterion& each : run.criteria) {
      Statement criterion(handle, "INSERT INTO criteria VALUES(?, ?, ?, ?, ?)");
      criterion.bind(experiment).bind(seed).bind(each.team).bind(each.value).bind(each.success);
      if (criterion.step() != SQLITE_DONE) return database_->error();
    }
    return {};
  };
  SL_TRY(database_->execute("BEGIN IMMEDIATE"));
  Status written = write();
  if (written) written = database_->execute("COMMIT");
  if (!written) sqlite3_exec(handle, "ROLLBACK", nullptr, nullptr, nullptr);
  return written;
}

}  // namespace sandlot::statistics
