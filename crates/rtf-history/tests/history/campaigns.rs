//! Campaigns: imported once, replaced after a resumption, pruned; rates, and where they changed.

use rtf_history::entry::{CampaignEnd, CampaignEntry, CampaignInfo, EpisodeEntry};
use rtf_history::store::Keep;
use rtf_history::{ImportOutcome, RunSelection, Store, StoreError};

use crate::world::{World, all_runs};

/// A campaign of 200 episodes on a day, of which some failed.
pub fn campaign(day: u32, commit: &str, failed: u32) -> CampaignEntry {
    let start: jiff::Timestamp = "2026-01-01T00:00:00Z".parse().expect("a time");
    let started = start + jiff::SignedDuration::from_hours(24 * i64::from(day));
    let is_failed = |id: u32| id <= failed;
    let episode = |id: u32| EpisodeEntry {
        id: id.into(),
        seed: id * 7,
        outcome: if is_failed(id) { "failed" } else { "passed" }.to_owned(),
        reason: is_failed(id).then(|| "too heavy; DROP TABLE\u{202e}".to_owned()),
        duration_us: 1500,
        values: vec![id.to_string(), "é \"wood\"".to_owned()],
    };
    let info = CampaignInfo {
        id: format!("campaign-{day:03}"),
        directory: format!("dir-{day:03}"),
        name: "grasp".to_owned(),
        file: "tests/grasp.xml".to_owned(),
        suite_file: "tests/suite.xml".to_owned(),
        started,
        ended: started + jiff::SignedDuration::from_secs(60),
        end: CampaignEnd::Finished,
        commit: Some(commit.to_owned()),
        branch: Some("main".to_owned()),
        dirty: Some(false),
        author_time: None,
        ci_job: None,
        host: "bench".to_owned(),
        profile: None,
        set: vec!["speed=3".to_owned()],
        rtf: "0.2.0".to_owned(),
        seed: 7,
        space: "5eed".to_owned(),
        claim: 0.9,
        rule: "fixed".to_owned(),
        confidence: 0.95,
        verdict: if failed < 10 { "passed" } else { "failed" }.to_owned(),
        planned: 200,
        run: 200,
        passed: u64::from(200 - failed),
        failed: failed.into(),
        without_result: 0,
        rate: rtf_statistics::exact_rate(u64::from(200 - failed), 200, 0.95),
    };
    let parameters = vec!["payload".to_owned(), "surface".to_owned()];
    CampaignEntry { info, parameters, episodes: (1..=200).map(episode).collect() }
}

/// Everything that a store knows of campaigns, as JSON.
pub fn dump(store: &Store) -> Vec<String> {
    let json = |value: Result<String, serde_json::Error>| value.expect("JSON");
    let last = RunSelection { last: Some(2), ..all_runs() };
    let mut all = Vec::new();
    for selection in [&all_runs(), &last] {
        let campaigns = store.campaigns(selection, None).expect("campaigns");
        all.push(json(serde_json::to_string(&campaigns)));
        let rates = store.campaign_rates(selection, None).expect("rates");
        all.push(json(serde_json::to_string(&rates)));
        let changes = store.campaign_changes(selection).expect("changes");
        all.push(json(serde_json::to_string(&changes)));
        let episodes = store.for_each_episode(selection, |line| {
            all.push(json(serde_json::to_string(&line)));
            Ok::<_, StoreError>(())
        });
        episodes.expect("episodes");
    }
    let mut directories: Vec<_> =
        store.campaign_directories().expect("directories").into_iter().collect();
    directories.sort();
    all.push(directories.join(" "));
    all.push(format!("{:?}", store.counts().expect("counts")));
    all
}

/// Six good ones, and then a drop.
pub fn campaigns() -> Vec<CampaignEntry> {
    let failed = [4, 6, 3, 5, 4, 6, 40, 38, 44];
    (1..).zip(failed).map(|(day, failed)| campaign(day, &format!("{day:08x}"), failed)).collect()
}

fn world(campaigns: &[CampaignEntry]) -> World {
    let mut world = World::new();
    for campaign in campaigns {
        let outcome = world.store.import_campaign(campaign).expect("an import");
        assert_eq!(outcome, ImportOutcome::Imported);
    }
    world
}

#[test]
fn a_drop_is_a_change_since_its_first_campaign() {
    let world = world(&campaigns());
    let changes = world.store.campaign_changes(&all_runs()).expect("changes");
    let [change] = changes.as_slice() else { panic!("{changes:?}") };
    assert_eq!((change.campaign.as_str(), change.name.as_str()), ("campaign-007", "grasp"));
    assert_eq!(change.commit.as_deref(), Some("00000007"));
    assert_eq!(change.commit_before.as_deref(), Some("00000006"));
    assert_eq!((change.before.campaigns, change.before.failed), (6, 28));
    assert_eq!((change.after.campaigns, change.after.failed), (3, 122));
    assert!(change.after.rate.high < change.before.rate.low && change.p_value < 1e-9, "{change:?}");
    let before = RunSelection { since: None, last: Some(3), ..all_runs() };
    assert_eq!(world.store.campaign_changes(&before).expect("changes"), []);
}

#[test]
fn campaigns_with_other_parameters_are_another_series() {
    let mut all = campaigns();
    all[6..].iter_mut().for_each(|it| it.info.space = "0ther".to_owned());
    let world = world(&all);
    assert_eq!(world.store.campaign_changes(&all_runs()).expect("changes"), []);
    let rates = world.store.campaign_rates(&all_runs(), Some("grasp")).expect("rates");
    assert_eq!(rates.iter().map(|it| it.points.len()).collect::<Vec<_>>(), [3, 6]);
    assert_eq!(world.store.campaign_rates(&all_runs(), Some("x")).expect("rates"), []);
}

#[test]
fn intervals_fit_the_stopping_rule() {
    let mut all = vec![campaign(1, "aa", 20), campaign(2, "aa", 20), campaign(3, "aa", 20)];
    all[1].info.rule = "confidence-sequence".to_owned();
    all[2].info.without_result = 10;
    let world = world(&all);
    let rates = world.store.campaign_rates(&all_runs(), None).expect("rates");
    let rates: Vec<_> = rates[0].points.iter().map(|it| it.rate.expect("a rate")).collect();
    assert_eq!(Some(rates[0]), rtf_statistics::rate(180, 200, 0.95));
    assert!(rates[1].low < rates[0].low && rates[1].high > rates[0].high, "{rates:?}");
    let worst = rtf_statistics::rate(180, 210, 0.95).expect("a rate").low;
    assert!((rates[2].low - worst).abs() < 1e-12 && rates[2].high > rates[0].high, "{rates:?}");
}

#[test]
fn a_campaign_is_imported_once_and_replaced_after_a_resumption() {
    let whole = campaign(1, "aa", 20);
    let mut part = whole.clone();
    part.episodes.truncate(90);
    part.info.run = 90;
    part.info.end = CampaignEnd::Interrupted;
    let mut world = world(std::slice::from_ref(&part));
    assert_eq!(world.store.import_campaign(&part).expect("an import"), ImportOutcome::Known);
    assert_eq!(world.store.import_campaign(&whole).expect("an import"), ImportOutcome::Replaced);
    assert_eq!(world.store.import_campaign(&part).expect("an import"), ImportOutcome::Known);
    assert_eq!(dump(&world.store), dump(&self::world(std::slice::from_ref(&whole)).store));
    let mut copied = campaign(2, "aa", 20);
    copied.info.id = whole.info.id;
    let error = world.store.import_campaign(&copied).expect_err("a conflict");
    assert!(matches!(&error, StoreError::SameCampaign { id } if id == "campaign-001"), "{error}");
    assert!(error.hint().is_some());
}

#[test]
fn old_campaigns_are_pruned_but_not_the_last_that_passed() {
    let all = campaigns();
    let mut world = world(&all);
    let before = dump(&world.store);
    let would = world.store.prunable_campaigns(Keep::Newest(2)).expect("campaigns");
    let removed = world.store.prune_campaigns(Keep::Newest(2)).expect("campaigns");
    assert_eq!(removed, would);
    let left = world.store.campaigns(&all_runs(), None).expect("campaigns");
    let left: Vec<_> = left.iter().map(|it| it.id.as_str()).collect();
    assert_eq!(left, ["campaign-009", "campaign-008", "campaign-006"]);
    assert_eq!(world.store.check().expect("a check"), Vec::<String>::new());
    let outcome = world.store.import_campaign(&all[0]).expect("no import");
    assert_eq!(outcome, ImportOutcome::Pruned);
    for campaign in &all {
        world.store.restore_campaign(campaign).expect("an import");
    }
    assert_eq!(dump(&world.store), before);
}

#[test]
fn a_database_of_the_first_version_is_read_and_extended() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("history.db");
    let connection = rusqlite::Connection::open(&path).expect("a database");
    connection.execute_batch(rtf_history::store::schema::MIGRATIONS[0]).expect("tables");
    connection.pragma_update(None, "user_version", 1).expect("a version");
    drop(connection);
    let mut store = Store::open(&path).expect("a store");
    assert_eq!(store.campaigns(&all_runs(), None).expect("campaigns"), []);
    let outcome = store.import_campaign(&campaign(1, "aa", 20)).expect("an import");
    assert_eq!(outcome, ImportOutcome::Imported);
    assert_eq!(store.counts().expect("counts").episodes, 200);
}
