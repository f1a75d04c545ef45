//! Stores, reads and removes campaigns.

use std::collections::HashSet;

use super::database::{Database, DatabaseError, Row, Value};
use super::json::json;
use super::read::{list, time, word};
use super::{ImportOutcome, Keep, Store, StoreError, sql};
use crate::entry::{CampaignEnd, CampaignEntry, CampaignInfo, EpisodeEntry};

/// How many episodes are in memory as values of the database.
const EPISODES_AT_ONCE: usize = 4096;

/// The first version of the database that has campaigns.
const FIRST_VERSION: i64 = 2;

impl Store {
    /// Imports a campaign that has ended, unless it was pruned.
    ///
    /// # Errors
    /// Another campaign has its identity, or the store cannot be written; then nothing has
    /// changed.
    pub fn import_campaign(&mut self, entry: &CampaignEntry) -> Result<ImportOutcome, StoreError> {
        self.store_campaign(entry, false)
    }

    /// Imports a campaign that has ended, even if it was pruned.
    ///
    /// # Errors
    /// As for [`Store::import_campaign`].
    pub fn restore_campaign(&mut self, entry: &CampaignEntry) -> Result<ImportOutcome, StoreError> {
        self.store_campaign(entry, true)
    }

    fn store_campaign(
        &mut self,
        entry: &CampaignEntry,
        restores: bool,
    ) -> Result<ImportOutcome, StoreError> {
        let info = &entry.info;
        let failed = |error| StoreError::new(&self.location, error);
        let transaction = self.database.begin().map_err(failed)?;
        let uid = [(&info.id).into()];
        let pruned = transaction.rows(sql::FIND_PRUNED_CAMPAIGN, &uid, |_| Ok(()));
        if !pruned.map_err(failed)?.is_empty() && !restores {
            return Ok(ImportOutcome::Pruned);
        }
        let found = transaction.rows(sql::FIND_CAMPAIGN, &uid, |row| {
            Ok((row.get::<i64>(0)?, row.get::<u64>(1)?, row.get::<i64>(2)?, row.get::<i64>(3)?))
        });
        let ended = info.ended.as_microsecond();
        let outcome = match found.map_err(failed)?.pop() {
            None => ImportOutcome::Imported,
            Some((_, _, _, started)) if started != info.started.as_microsecond() => {
                return Err(StoreError::SameCampaign { id: info.id.clone() });
            }
            // A campaign that was resumed has more results, or others later.
            Some((id, episodes, until, _)) if (info.run, ended) > (episodes, until) => {
                transaction.delete(&sql::DELETE_CAMPAIGN, id).map_err(failed)?;
                ImportOutcome::Replaced
            }
            Some(_) => return Ok(ImportOutcome::Known),
        };
        let stored = transaction.execute(sql::DELETE_PRUNED_CAMPAIGN, &uid);
        stored
            .and_then(|()| insert(&transaction, entry))
            .and_then(|()| transaction.commit())
            .map_err(failed)?;
        Ok(outcome)
    }

    /// All campaigns, the oldest first.
    pub(crate) fn all_campaigns(&self) -> Result<Vec<(i64, CampaignInfo)>, StoreError> {
        if self.has_campaigns()? { self.rows(sql::CAMPAIGNS, &[], campaign) } else { Ok(vec![]) }
    }

    /// The names of the parameters of a campaign, and its episodes that have run.
    pub(crate) fn episodes_of(
        &self,
        campaign: i64,
    ) -> Result<(Vec<String>, Vec<EpisodeEntry>), StoreError> {
        let id = [campaign.into()];
        let names = self.rows(sql::CAMPAIGN_PARAMETERS, &id, |row| list(row, 0))?.pop();
        Ok((names.unwrap_or_default(), self.rows(sql::EPISODES, &id, episode)?))
    }

    /// The names of the directories of stored and pruned campaigns.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn campaign_directories(&self) -> Result<HashSet<String>, StoreError> {
        if !self.has_campaigns()? {
            return Ok(HashSet::new());
        }
        let names = self.rows(sql::CAMPAIGN_DIRECTORIES, &[], |row| row.get::<String>(0))?;
        Ok(names.into_iter().collect())
    }

    /// The numbers of campaigns, of their episodes, and of pruned campaigns.
    pub(super) fn campaign_counts(&self) -> Result<[u64; 3], StoreError> {
        if !self.has_campaigns()? {
            return Ok([0; 3]);
        }
        let read = |row: &Row<'_>| Ok([row.get(0)?, row.get(1)?, row.get(2)?]);
        Ok(self.rows(sql::CAMPAIGN_COUNTS, &[], read)?.pop().unwrap_or_default())
    }

    /// Whether the database has the tables: an earlier one that cannot be written has none.
    fn has_campaigns(&self) -> Result<bool, StoreError> {
        let Database::Sqlite(_) = &self.database else { return Ok(true) };
        let version = self.rows("PRAGMA user_version", &[], |row| row.get::<i64>(0))?.pop();
        Ok(version.is_some_and(|version| version >= FIRST_VERSION))
    }

    /// The campaigns that [`Store::prune_campaigns`] would remove, the oldest first. Of the
    /// campaigns of one file and name, the last one that passed stays.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn prunable_campaigns(&self, keep: Keep) -> Result<Vec<CampaignInfo>, StoreError> {
        Ok(self.find_prunable_campaigns(keep)?.into_iter().map(|(_, info)| info).collect())
    }

    /// Removes campaigns, and remembers their identities.
    ///
    /// # Errors
    /// The database cannot be written; then nothing has changed.
    pub fn prune_campaigns(&mut self, keep: Keep) -> Result<Vec<CampaignInfo>, StoreError> {
        let removed = self.find_prunable_campaigns(keep)?;
        let names = removed.iter().map(|(id, info)| (*id, [&info.id, &info.directory]));
        self.remove(names, &sql::DELETE_CAMPAIGN, sql::INSERT_PRUNED_CAMPAIGN, &[])?;
        Ok(removed.into_iter().map(|(_, info)| info).collect())
    }

    fn find_prunable_campaigns(&self, keep: Keep) -> Result<Vec<(i64, CampaignInfo)>, StoreError> {
        let mut passed_later = HashSet::new();
        let mut prunable = Vec::new();
        for (newer, (id, info)) in self.all_campaigns()?.into_iter().rev().enumerate() {
            let is_kept = keep.keeps(newer, info.started);
            let series = (info.file.clone(), info.name.clone());
            let is_last_pass = info.verdict == "passed" && passed_later.insert(series);
            if !is_kept && !is_last_pass {
                prunable.push((id, info));
            }
        }
        prunable.reverse();
        Ok(prunable)
    }
}

fn insert(database: &Database, entry: &CampaignEntry) -> Result<(), DatabaseError> {
    let info = &entry.info;
    let (settings, parameters) = (json(&info.set), json(&entry.parameters));
    let mut values: Vec<Value<'_>> = Vec::with_capacity(32);
    values.extend(
        [&info.id, &info.directory, &info.name, &info.file, &info.suite_file].map(Value::from),
    );
    values.extend::<[Value<'_>; 11]>([
        info.started.as_microsecond().into(),
        info.ended.as_microsecond().into(),
        info.end.as_str().into(),
        info.commit.as_ref().into(),
        info.branch.as_ref().into(),
        info.dirty.into(),
        info.author_time.as_ref().into(),
        info.ci_job.as_ref().into(),
        (&info.host).into(),
        info.profile.as_ref().into(),
        (&settings).into(),
    ]);
    values.extend::<[Value<'_>; 7]>([
        (&info.rtf).into(),
        info.seed.into(),
        (&info.space).into(),
        info.claim.into(),
        (&info.rule).into(),
        info.confidence.into(),
        (&info.verdict).into(),
    ]);
    values.extend(
        [info.planned, info.run, info.passed, info.failed, info.without_result].map(Value::from),
    );
    let rate = info.rate.as_ref();
    let rate = [rate.map(|it| it.value), rate.map(|it| it.low), rate.map(|it| it.high)];
    values.extend(rate.map(Value::from));
    values.push((&parameters).into());
    let ids = database.rows(sql::INSERT_CAMPAIGN, &values, |row| row.get::<i64>(0))?;
    let id = ids.into_iter().next().unwrap_or_default();
    entry.episodes.chunks(EPISODES_AT_ONCE).try_for_each(|part| insert_episodes(database, id, part))
}

fn insert_episodes(
    database: &Database,
    campaign: i64,
    episodes: &[EpisodeEntry],
) -> Result<(), DatabaseError> {
    let texts: Vec<String> = episodes.iter().map(|episode| json(&episode.values)).collect();
    let mut rows: Vec<Value<'_>> = Vec::with_capacity(texts.len() * sql::INSERT_EPISODES.columns);
    for (episode, parameters) in episodes.iter().zip(&texts) {
        rows.extend::<[Value<'_>; 7]>([
            campaign.into(),
            episode.id.into(),
            episode.seed.into(),
            (&episode.outcome).into(),
            episode.reason.as_ref().into(),
            episode.duration_us.into(),
            parameters.into(),
        ]);
    }
    database.batch(&sql::INSERT_EPISODES, &rows, &mut |_| Ok(()))
}

fn campaign(row: &Row<'_>) -> Result<(i64, CampaignInfo), DatabaseError> {
    let rate = match (row.get(29)?, row.get(30)?, row.get(31)?) {
        (Some(value), Some(low), Some(high)) => Some(rtf_statistics::Rate { value, low, high }),
        _ => None,
    };
    let info = CampaignInfo {
        id: row.get(1)?,
        directory: row.get(2)?,
        name: row.get(3)?,
        file: row.get(4)?,
        suite_file: row.get(5)?,
        started: time(row.get(6)?),
        ended: time(row.get(7)?),
        end: word(row, 8)?.unwrap_or(CampaignEnd::Unfinished),
        commit: row.get(9)?,
        branch: row.get(10)?,
        dirty: row.get(11)?,
        author_time: row.get(12)?,
        ci_job: row.get(13)?,
        host: row.get(14)?,
        profile: row.get(15)?,
        set: list(row, 16)?,
        rtf: row.get(17)?,
        seed: row.get(18)?,
        space: row.get(19)?,
        claim: row.get(20)?,
        rule: row.get(21)?,
        confidence: row.get(22)?,
        verdict: row.get(23)?,
        planned: row.get(24)?,
        run: row.get(25)?,
        passed: row.get(26)?,
        failed: row.get(27)?,
        without_result: row.get(28)?,
        rate,
    };
    Ok((row.get(0)?, info))
}

fn episode(row: &Row<'_>) -> Result<EpisodeEntry, DatabaseError> {
    Ok(EpisodeEntry {
        id: row.get(0)?,
        seed: row.get(1)?,
        outcome: row.get(2)?,
        reason: row.get(3)?,
        duration_us: row.get(4)?,
        values: list(row, 5)?,
    })
}
