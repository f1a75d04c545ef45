//! `eval_info.json` of LeRobot: `lerobot-eval` writes `per_task` since 0.4, and wrote
//! `per_episode` before; `eval_policy` still returns the latter.

use std::collections::BTreeMap;

use rtf_model::Parameter;
use serde::Deserialize;

use super::{ResultsProblem, ResultsProblemKind as Kind};
use crate::comparison::{ComparedEpisode, MeasurementKey};

/// What is read of the file.
#[derive(Deserialize)]
struct EvalInfo {
    per_episode: Option<Vec<Episode>>,
    per_task: Option<Vec<Task>>,
}

#[derive(Deserialize)]
struct Episode {
    episode_ix: u64,
    success: bool,
    sum_reward: Option<f64>,
    max_reward: Option<f64>,
    seed: Option<u64>,
}

#[derive(Deserialize)]
struct Task {
    task_group: String,
    task_id: u64,
    metrics: Metrics,
}

/// Of each episode of a task.
#[derive(Deserialize)]
struct Metrics {
    successes: Vec<bool>,
    #[serde(default)]
    sum_rewards: Vec<Option<f64>>,
    #[serde(default)]
    max_rewards: Vec<Option<f64>>,
}

/// Reads the text of a file.
///
/// # Errors
/// It is not such a file: the first problem.
pub fn read(text: &str) -> Result<Vec<ComparedEpisode>, ResultsProblem> {
    let info: EvalInfo = serde_json::from_str(text).map_err(|error| {
        let line = error.line().max(1) as u64;
        Kind::NotLeRobot(error.to_string()).at(line)
    })?;
    let episodes: Vec<_> = match info {
        EvalInfo { per_episode: Some(episodes), .. } => {
            episodes.into_iter().map(of_episode).collect()
        }
        EvalInfo { per_task: Some(tasks), .. } => {
            let mut episodes: Vec<_> = tasks.iter().flat_map(of_task).collect();
            episodes.iter_mut().zip(0..).for_each(|(episode, id)| episode.id = id);
            episodes
        }
        EvalInfo { per_episode: None, per_task: None } => return Err(Kind::NoEvaluation.at(1)),
    };
    if episodes.is_empty() { Err(Kind::NoEpisodes.at(1)) } else { Ok(episodes) }
}

fn of_episode(episode: Episode) -> ComparedEpisode {
    ComparedEpisode {
        first_observation: None,
        id: episode.episode_ix,
        seed: episode.seed,
        parameters: Vec::new(),
        passed: Some(episode.success),
        values: rewards(episode.sum_reward, episode.max_reward),
    }
}

/// The episodes of a task, whose seeds the file does not have.
fn of_task(task: &Task) -> impl Iterator<Item = ComparedEpisode> {
    let Metrics { successes, sum_rewards, max_rewards } = &task.metrics;
    let parameter = |name: &str, value: String| Parameter { name: name.to_owned(), value };
    successes.iter().enumerate().map(move |(index, success)| {
        let reward = |rewards: &[Option<f64>]| rewards.get(index).copied().flatten();
        let task_name = format!("{}/{}", task.task_group, task.task_id);
        ComparedEpisode {
            first_observation: None,
            id: 0,
            seed: None,
            parameters: vec![
                parameter("task_group", task.task_group.clone()),
                parameter("task", task_name),
            ],
            passed: Some(*success),
            values: rewards(reward(sum_rewards), reward(max_rewards)),
        }
    })
}

fn rewards(sum: Option<f64>, max: Option<f64>) -> BTreeMap<MeasurementKey, f64> {
    let named = [("sum_reward", sum), ("max_reward", max)].into_iter();
    let key = |name: &str| (String::new(), name.to_owned(), String::new());
    named
        .filter_map(|(name, value)| Some((key(name), value.filter(|it| it.is_finite())?)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `lerobot-eval` 0.3 writes it.
    const PER_EPISODE: &str = r#"{
  "per_episode": [
    {"episode_ix": 0, "sum_reward": 58.5, "max_reward": 1.0, "success": true, "seed": 1000},
    {"episode_ix": 1, "sum_reward": 12.25, "max_reward": 0.5, "success": false, "seed": 1001}
  ],
  "aggregated": {"avg_sum_reward": 35.375, "pc_success": 50.0, "eval_s": 9.5}
}"#;
    /// As `lerobot-eval` 0.4.4 writes it.
    const PER_TASK: &str = r#"{
  "per_task": [
    {"task_group": "libero_10", "task_id": 0, "metrics": {
      "sum_rewards": [1.0, 0.0], "max_rewards": [1.0, 0.0], "successes": [true, false],
      "video_paths": ["videos/libero_10_0/eval_episode_0.mp4"]}},
    {"task_group": "libero_10", "task_id": 7, "metrics": {
      "sum_rewards": [1.0], "max_rewards": [1.0], "successes": [true], "video_paths": []}}
  ],
  "per_group": {"libero_10": {"pc_success": 66.7, "n_episodes": 3, "video_paths": []}},
  "overall": {"pc_success": 66.7, "n_episodes": 3, "eval_s": 9.5, "video_paths": []}
}"#;

    #[test]
    fn episodes_of_one_task_have_seeds() {
        let found = read(PER_EPISODE).unwrap();
        let results: Vec<_> = found.iter().map(|it| (it.id, it.seed, it.passed)).collect();
        assert_eq!(results, [(0, Some(1000), Some(true)), (1, Some(1001), Some(false))]);
        let names: Vec<_> = found[0].values.iter().map(|(it, value)| (&*it.1, *value)).collect();
        assert_eq!(names, [("max_reward", 1.0), ("sum_reward", 58.5)]);
    }

    #[test]
    fn episodes_of_several_tasks_have_parameters() {
        let found = read(PER_TASK).unwrap();
        let task = |it: &ComparedEpisode| (it.id, it.seed, it.parameters[1].value.clone());
        let expected = [(0, "libero_10/0"), (1, "libero_10/0"), (2, "libero_10/7")];
        assert_eq!(
            found.iter().map(task).collect::<Vec<_>>(),
            expected.map(|(id, name)| (id, None, name.to_owned()))
        );
        assert_eq!(found.iter().filter(|it| it.passed == Some(true)).count(), 2);
    }

    #[test]
    fn other_files() {
        let problem = |text: &str| {
            let problem = read(text).unwrap_err();
            (problem.line, problem.to_string())
        };
        let (line, text) = problem("{\n  \"per_episode\": [{\"episode_ix\": 0}]\n}");
        assert_eq!(line, 2);
        assert!(text.contains("missing field `success`"), "{text}");
        assert_eq!(problem("{\"overall\": {}}").1, Kind::NoEvaluation.to_string());
        assert_eq!(problem("{\"per_task\": []}").1, "there are no episodes");
        assert_eq!(problem("{\"per_episode\": [{\"episode_ix\": NaN}]}").0, 1);
    }
}
