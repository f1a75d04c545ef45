//! The tables of the store. The migrations are those of SQLite; for PostgreSQL, the types of columns are
//! replaced.

/// Identifies the store among SQLite databases (`PRAGMA application_id`): "RTFH".
pub const APPLICATION_ID: i64 = 0x5254_4648;

/// The migrations, in order. A released one is never changed.
pub const MIGRATIONS: &[&str] = &[VERSION_1, VERSION_2, VERSION_3];

const VERSION_1: &str = "
CREATE TABLE run (
  id INTEGER PRIMARY KEY,
  uid TEXT NOT NULL UNIQUE,
  name TEXT NOT NULL,
  started_us BIGINT NOT NULL,
  duration_us BIGINT NOT NULL,
  ended TEXT NOT NULL,
  green SMALLINT NOT NULL,
  passed INTEGER NOT NULL,
  failed INTEGER NOT NULL,
  error INTEGER NOT NULL,
  crashed INTEGER NOT NULL,
  timed_out INTEGER NOT NULL,
  collapsed INTEGER NOT NULL,
  skipped INTEGER NOT NULL,
  interrupted INTEGER NOT NULL,
  commit_hash TEXT,
  branch TEXT,
  dirty SMALLINT,
  author_time TEXT,
  ci_job TEXT,
  host TEXT,
  cpus INTEGER,
  load_percent INTEGER,
  profile TEXT,
  parameters TEXT NOT NULL,
  rtf TEXT NOT NULL,
  events BIGINT NOT NULL,
  started TEXT NOT NULL
);
CREATE INDEX run_name ON run (name);

CREATE TABLE test (
  id INTEGER PRIMARY KEY,
  suite_file TEXT NOT NULL,
  suite TEXT NOT NULL,
  name TEXT NOT NULL,
  case_path TEXT NOT NULL,
  plugin_type TEXT NOT NULL,
  tags TEXT NOT NULL,
  parameters TEXT NOT NULL,
  seen_us BIGINT NOT NULL,
  renamed_to BIGINT REFERENCES test (id),
  UNIQUE (suite_file, suite, name, case_path)
);

CREATE TABLE result (
  test_id BIGINT NOT NULL REFERENCES test (id),
  run_id BIGINT NOT NULL REFERENCES run (id),
  verdict TEXT NOT NULL,
  flaky SMALLINT NOT NULL,
  attempts INTEGER NOT NULL,
  problems INTEGER NOT NULL,
  duration_us BIGINT,
  reason TEXT,
  robot TEXT NOT NULL,
  plugin_hash TEXT,
  PRIMARY KEY (test_id, run_id)
) WITHOUT ROWID;
CREATE INDEX result_run ON result (run_id);
CREATE INDEX result_problem ON result (test_id) WHERE verdict <> 'passed' OR flaky = 1;

CREATE TABLE series (
  id INTEGER PRIMARY KEY,
  test_id BIGINT NOT NULL REFERENCES test (id),
  kind TEXT NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  UNIQUE (test_id, kind, name, unit)
);
CREATE INDEX series_name ON series (name);

CREATE TABLE point (
  test_id BIGINT NOT NULL REFERENCES test (id),
  run_id BIGINT NOT NULL REFERENCES run (id),
  series_id BIGINT NOT NULL REFERENCES series (id),
  value DOUBLE PRECISION,
  min DOUBLE PRECISION,
  max DOUBLE PRECISION,
  count BIGINT NOT NULL,
  not_finite BIGINT NOT NULL,
  outside BIGINT NOT NULL,
  low DOUBLE PRECISION,
  high DOUBLE PRECISION,
  PRIMARY KEY (test_id, run_id, series_id)
) WITHOUT ROWID;
CREATE INDEX point_run ON point (run_id);

CREATE TABLE run_columns (
  run_id BIGINT PRIMARY KEY REFERENCES run (id),
  results BLOB NOT NULL,
  points BLOB NOT NULL
);

CREATE TABLE pruned (
  uid TEXT PRIMARY KEY,
  name TEXT NOT NULL
);
";

const VERSION_2: &str = "
CREATE TABLE campaign (
  id INTEGER PRIMARY KEY,
  uid TEXT NOT NULL UNIQUE,
  directory TEXT NOT NULL,
  name TEXT NOT NULL,
  file TEXT NOT NULL,
  suite_file TEXT NOT NULL,
  started_us BIGINT NOT NULL,
  ended_us BIGINT NOT NULL,
  ended TEXT NOT NULL,
  commit_hash TEXT,
  branch TEXT,
  dirty SMALLINT,
  author_time TEXT,
  ci_job TEXT,
  host TEXT NOT NULL,
  profile TEXT,
  settings TEXT NOT NULL,
  rtf TEXT NOT NULL,
  seed BIGINT NOT NULL,
  space TEXT NOT NULL,
  claim DOUBLE PRECISION NOT NULL,
  rule TEXT NOT NULL,
  confidence DOUBLE PRECISION NOT NULL,
  verdict TEXT NOT NULL,
  planned BIGINT NOT NULL,
  episodes BIGINT NOT NULL,
  passed BIGINT NOT NULL,
  failed BIGINT NOT NULL,
  without_result BIGINT NOT NULL,
  rate DOUBLE PRECISION,
  low DOUBLE PRECISION,
  high DOUBLE PRECISION,
  parameters TEXT NOT NULL
);

CREATE TABLE episode (
  campaign_id BIGINT NOT NULL REFERENCES campaign (id),
  episode BIGINT NOT NULL,
  seed BIGINT NOT NULL,
  outcome TEXT NOT NULL,
  reason TEXT,
  duration_us BIGINT NOT NULL,
  parameters TEXT NOT NULL,
  PRIMARY KEY (campaign_id, episode)
) WITHOUT ROWID;

CREATE TABLE pruned_campaign (
  uid TEXT PRIMARY KEY,
  directory TEXT NOT NULL
);
";

const VERSION_3: &str = "
ALTER TABLE result ADD COLUMN source_hash TEXT;
ALTER TABLE run_columns ADD COLUMN sources BLOB;
";

/// In PostgreSQL: the schema with the tables, and their version.
pub const POSTGRES_SCHEMA: &str = "
CREATE SCHEMA IF NOT EXISTS rtf_history;
CREATE TABLE IF NOT EXISTS migration (version BIGINT PRIMARY KEY)";
/// In PostgreSQL: whether there are tables.
pub const POSTGRES_TABLE: &str = "SELECT to_regclass('rtf_history.migration')::text";
/// In PostgreSQL: the number of the last migration.
pub const POSTGRES_VERSION: &str = "SELECT MAX(version) FROM migration";
/// In PostgreSQL: remembers a migration.
pub const POSTGRES_MIGRATED: &str = "INSERT INTO migration (version) VALUES ($1)";
