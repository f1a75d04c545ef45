//! The statements of the store.
//!
//! They are portable: `$1` parameters in the order of their numbers, `ON CONFLICT`, no type that
//! only one database has.

use super::database::Batch;

/// The stored state of a campaign with an identity.
pub const FIND_CAMPAIGN: &str =
    "SELECT id, episodes, ended_us, started_us FROM campaign WHERE uid = $1";
pub const FIND_PRUNED_CAMPAIGN: &str = "SELECT 1 FROM pruned_campaign WHERE uid = $1";
/// The directories of stored and pruned campaigns.
pub const CAMPAIGN_DIRECTORIES: &str =
    "SELECT directory FROM campaign UNION SELECT directory FROM pruned_campaign";
pub const INSERT_CAMPAIGN: &str = "
INSERT INTO campaign (uid, directory, name, file, suite_file, started_us, ended_us, ended,
  commit_hash, branch, dirty, author_time, ci_job, host, profile, settings, rtf, seed, space, claim,
  rule, confidence, verdict, planned, episodes, passed, failed, without_result, rate, low, high,
  parameters)
VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, $18, $19, $20,
  $21, $22, $23, $24, $25, $26, $27, $28, $29, $30, $31, $32)
RETURNING id";
pub(super) const INSERT_EPISODES: Batch = Batch {
    head: "
INSERT INTO episode (campaign_id, episode, seed, outcome, reason, duration_us, parameters)
VALUES",
    columns: 7,
    tail: "",
};
/// The parts of a campaign, in the order in which they are deleted.
pub const DELETE_CAMPAIGN: [&str; 2] =
    ["DELETE FROM episode WHERE campaign_id = $1", "DELETE FROM campaign WHERE id = $1"];
pub const INSERT_PRUNED_CAMPAIGN: &str = "
INSERT INTO pruned_campaign (uid, directory) VALUES ($1, $2) ON CONFLICT (uid) DO NOTHING";
pub const DELETE_PRUNED_CAMPAIGN: &str = "DELETE FROM pruned_campaign WHERE uid = $1";
/// All campaigns, the oldest first.
pub const CAMPAIGNS: &str = "
SELECT id, uid, directory, name, file, suite_file, started_us, ended_us, ended, commit_hash, branch,
  dirty, author_time, ci_job, host, profile, settings, rtf, seed, space, claim, rule, confidence,
  verdict, planned, episodes, passed, failed, without_result, rate, low, high
FROM campaign ORDER BY started_us, uid";
/// The names of the parameters of a campaign.
pub const CAMPAIGN_PARAMETERS: &str = "SELECT parameters FROM campaign WHERE id = $1";
pub const EPISODES: &str = "
SELECT episode, seed, outcome, reason, duration_us, parameters
FROM episode WHERE campaign_id = $1 ORDER BY episode";
/// Number of campaigns, of their episodes, and of pruned ones.
pub const CAMPAIGN_COUNTS: &str = "
SELECT (SELECT COUNT(*) FROM campaign), (SELECT COUNT(*) FROM episode),
  (SELECT COUNT(*) FROM pruned_campaign)";

/// The stored state of a run with an identity.
pub const FIND_RUN: &str = "SELECT id, events, started FROM run WHERE uid = $1";
pub const FIND_PRUNED: &str = "SELECT 1 FROM pruned WHERE uid = $1";
/// The names of stored and pruned runs.
pub const RUN_NAMES: &str = "SELECT name FROM run UNION SELECT name FROM pruned";

pub const INSERT_RUN: &str = "
INSERT INTO run (uid, name, started_us, duration_us, ended, green, passed, failed, error, crashed,
  timed_out, collapsed, skipped, interrupted, commit_hash, branch, dirty, author_time, ci_job,
  host, cpus, load_percent, profile, parameters, rtf, events, started)
VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, $18, $19, $20,
  $21, $22, $23, $24, $25, $26, $27)
RETURNING id";
/// The parts of a run, in the order in which they are deleted.
pub const DELETE_RUN: [&str; 4] = [
    "DELETE FROM run_columns WHERE run_id = $1",
    "DELETE FROM point WHERE run_id = $1",
    "DELETE FROM result WHERE run_id = $1",
    "DELETE FROM run WHERE id = $1",
];
/// Deletes series, and then tests, that no run has any more.
pub const DELETE_UNUSED: [&str; 2] = [
    "DELETE FROM series WHERE NOT EXISTS
       (SELECT 1 FROM point WHERE point.test_id = series.test_id AND point.series_id = series.id)",
    "DELETE FROM test WHERE renamed_to IS NULL
       AND NOT EXISTS (SELECT 1 FROM result WHERE result.test_id = test.id)
       AND NOT EXISTS (SELECT 1 FROM series WHERE series.test_id = test.id)
       AND NOT EXISTS (SELECT 1 FROM test AS former WHERE former.renamed_to = test.id)",
];
/// Remembers a run that is not stored: it was pruned, or merged from others.
pub const INSERT_PRUNED: &str =
    "INSERT INTO pruned (uid, name) VALUES ($1, $2) ON CONFLICT (uid) DO NOTHING";
pub const DELETE_PRUNED: &str = "DELETE FROM pruned WHERE uid = $1";

/// Tests with their attributes.
pub(super) const FIND_TESTS: Batch = Batch {
    head: "
WITH wanted (a, b, c, d) AS (VALUES",
    columns: 4,
    tail: ")
SELECT id, suite_file, suite, name, case_path, plugin_type, tags, parameters, seen_us
FROM wanted CROSS JOIN test
WHERE suite_file = a AND suite = b AND name = c AND case_path = d",
};
/// The start of the newest run with a test.
pub const NEWEST_START: &str = "
SELECT MAX(started_us) FROM result JOIN run ON run.id = run_id WHERE test_id = $1";
/// Adds tests, or updates the attributes of those of which this run is the newest one.
pub(super) const UPSERT_TESTS: Batch = Batch {
    head: "
INSERT INTO test (suite_file, suite, name, case_path, plugin_type, tags, parameters, seen_us)
VALUES",
    columns: 8,
    tail: "
ON CONFLICT (suite_file, suite, name, case_path) DO UPDATE SET
  plugin_type = CASE WHEN excluded.seen_us >= test.seen_us
    THEN excluded.plugin_type ELSE test.plugin_type END,
  tags = CASE WHEN excluded.seen_us >= test.seen_us THEN excluded.tags ELSE test.tags END,
  parameters = CASE WHEN excluded.seen_us >= test.seen_us
    THEN excluded.parameters ELSE test.parameters END,
  seen_us = CASE WHEN excluded.seen_us >= test.seen_us
    THEN excluded.seen_us ELSE test.seen_us END
RETURNING id, suite_file, suite, name, case_path",
};
/// Leads from a former name to the current one.
pub const RENAME_TEST: &str = "UPDATE test SET renamed_to = $1 WHERE id = $2";
pub(super) const INSERT_RESULTS: Batch = Batch {
    head: "
INSERT INTO result (test_id, run_id, verdict, flaky, attempts, problems, duration_us, reason,
  robot, plugin_hash, source_hash)
VALUES",
    columns: 11,
    tail: "",
};
pub(super) const FIND_SERIES: Batch = Batch {
    head: "SELECT id, kind, name, unit, test_id FROM series WHERE test_id IN (",
    columns: 1,
    tail: ")",
};
pub(super) const INSERT_SERIES: Batch = Batch {
    head: "INSERT INTO series (test_id, kind, name, unit) VALUES",
    columns: 4,
    tail: " RETURNING id, kind, name, unit, test_id",
};
pub(super) const INSERT_POINTS: Batch = Batch {
    head: "
INSERT INTO point (test_id, run_id, series_id, value, min, max, count, not_finite, outside, low,
  high)
VALUES",
    columns: 11,
    tail: "",
};
/// Adds the packed results and points of a run.
pub const INSERT_RUN_COLUMNS: &str =
    "INSERT INTO run_columns (run_id, results, points, sources) VALUES ($1, $2, $3, $4)";

/// All runs, the oldest first.
pub const RUNS: &str = "
SELECT id, uid, name, started_us, duration_us, ended, green, passed, failed, error, crashed,
  timed_out, collapsed, skipped, interrupted, commit_hash, branch, dirty, author_time, ci_job,
  host, cpus, load_percent, profile, parameters, rtf
FROM run ORDER BY started_us, uid";
pub const TESTS: &str = "
SELECT id, suite_file, suite, name, case_path, plugin_type, tags, parameters, renamed_to
FROM test ORDER BY suite_file, suite, name, case_path";
pub const RESULTS_OF_TEST: &str = "
SELECT run_id, verdict, flaky, attempts, problems, duration_us, reason, robot, plugin_hash,
  source_hash
FROM result WHERE test_id = $1";
pub const RESULT_OF_TEST: &str = "
SELECT run_id, verdict, flaky, attempts, problems, duration_us, reason, robot, plugin_hash,
  source_hash
FROM result WHERE test_id = $1 AND run_id = $2";
/// The packed results of the runs in a range of ids.
pub const RESULT_COLUMNS: &str = "
SELECT run_id, results, sources FROM run_columns WHERE run_id BETWEEN $1 AND $2 ORDER BY run_id";
/// The packed points of the runs in a range of ids.
pub const POINT_COLUMNS: &str = "
SELECT run_id, points FROM run_columns WHERE run_id BETWEEN $1 AND $2 ORDER BY run_id";
/// The tests with at least one result that is not a plain pass.
pub const TESTS_WITH_PROBLEMS: &str =
    "SELECT DISTINCT test_id FROM result WHERE verdict <> 'passed' OR flaky = 1";
pub const PASSED_TESTS_OF_RUN: &str =
    "SELECT test_id FROM result WHERE run_id = $1 AND verdict = 'passed'";
pub const SERIES_OF_TEST: &str =
    "SELECT id, kind, name, unit FROM series WHERE test_id = $1 ORDER BY kind, name, unit";
pub const SERIES: &str = "SELECT id, kind, name, unit, test_id FROM series ORDER BY id";
pub const TESTS_WITH_SERIES: &str = "SELECT DISTINCT test_id FROM series WHERE name = $1";
pub const SERIES_NAMES: &str = "SELECT DISTINCT name FROM series ORDER BY name";
/// The points of a test, in all its series.
pub const POINTS_OF_TEST: &str = "
SELECT run_id, series_id, value, min, max, count, not_finite, outside, low, high
FROM point WHERE test_id = $1";
pub const COUNTS: &str = "
SELECT (SELECT COUNT(*) FROM run), (SELECT COUNT(*) FROM test), (SELECT COUNT(*) FROM result),
  (SELECT COUNT(*) FROM series), (SELECT COUNT(*) FROM point), (SELECT COUNT(*) FROM pruned)";
