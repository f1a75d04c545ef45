//! `rtf campaign search`: runs episodes that another program asks for, in lines of JSON.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader};
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_campaign::episodes::SeedStream;
use rtf_campaign::ranges::{meet_constraints, value_of};
use rtf_coordinator::stream_pool::{Ended, POLL, StreamPool};
use rtf_engine::signal::SignalListener;
use rtf_model::{Episode, Parameter};
use rtf_report::episode_results::EpisodeLine;
use rtf_run::campaign::directory::CampaignDir;
use rtf_run::campaign::{self, LoadedCampaign};
use rtf_run::error::Failure;
use rtf_run::terminal;
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::sync::mpsc;

use super::run::describe_search;
use crate::cli::CampaignSearchArgs;
use crate::command::VerbResult;
use crate::request::config;

/// Runs what standard input asks for.
pub fn run(mut args: CampaignSearchArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_past_results(&mut args.results, matches)?;
    let loaded = campaign::load(&args.file)?;
    loaded.print_warnings()?;
    campaign::refuse_versions(&loaded)?;
    let description = describe_search(&loaded, &args.file, &args.profile)?;
    let dir = CampaignDir::create(&args.results.results.join("searches"), description, None)?;
    let mut pool = StreamPool::new(&dir, args.workers.get().into(), args.shutdown_timeout)?;
    let header = json!({ "campaign": loaded.name, "parameters": loaded.ranges });
    terminal::stdout(|out| writeln!(out, "{header}").and_then(|()| out.flush()))?;
    let lines = read_lines()?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let ended = runtime.map_err(Failure::internal)?.block_on(async {
        let mut signals = SignalListener::install().map_err(Failure::internal)?;
        let seeds = SeedStream::new(loaded.campaign.seed);
        let mut search = Search { loaded: &loaded, seeds, asked: BTreeMap::new(), lines: 0 };
        let searched = search.run(&mut pool, lines, &mut signals).await;
        let code = pool.finish(searched.as_ref().err(), &mut signals).await?;
        Ok::<_, Failure>((searched, code))
    });
    let dir = dir.path.display();
    terminal::stderr(|err| writeln!(err, "results: {dir}"))?;
    match ended? {
        (_, Some(code)) => Ok(code),
        (Ok(()), None) => Ok(ExitCode::SUCCESS),
        (Err(ended), None) => ended.into_result(),
    }
}

/// The lines of standard input, read by a thread that ends with the process.
fn read_lines() -> Result<mpsc::UnboundedReceiver<String>, Failure> {
    let (sender, receiver) = mpsc::unbounded_channel();
    let read = move || {
        let lines = BufReader::new(std::io::stdin()).split(b'\n').map_while(Result::ok);
        for line in lines {
            if sender.send(String::from_utf8_lossy(&line).into_owned()).is_err() {
                return;
            }
        }
    };
    let thread = std::thread::Builder::new().name("questions".to_owned()).spawn(read);
    thread.map(|_| receiver).map_err(Failure::internal)
}

/// A line of the other program.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Ask {
    /// Those that are not named are nominal.
    #[serde(default)]
    parameters: BTreeMap<String, Value>,
    seed: Option<u32>,
}

struct Search<'a> {
    loaded: &'a LoadedCampaign,
    seeds: SeedStream,
    /// Of each episode, the number of its line, and itself.
    asked: BTreeMap<u64, (u64, Episode)>,
    /// How many lines were read.
    lines: u64,
}

impl Search<'_> {
    async fn run(
        &mut self,
        pool: &mut StreamPool<'_>,
        mut lines: mpsc::UnboundedReceiver<String>,
        signals: &mut SignalListener,
    ) -> Result<(), Ended> {
        let mut is_open = true;
        while is_open || !pool.is_idle() {
            tokio::select! {
                (number, _) = signals.next() => return Err(Ended::Signal(number)),
                line = lines.recv(), if is_open => match line {
                    Some(line) => self.on_line(&line, pool)?,
                    None => is_open = false,
                },
                () = tokio::time::sleep(POLL), if !pool.is_idle() => {}
            }
            for line in pool.step()? {
                self.answer(line)?;
            }
        }
        Ok(())
    }

    fn on_line(&mut self, line: &str, pool: &mut StreamPool<'_>) -> Result<(), Failure> {
        self.lines += 1;
        let ask = self.lines;
        match self.episode(line) {
            Ok(episode) => {
                self.asked.insert(episode.id, (ask, episode.clone()));
                pool.ask(episode)
            }
            Err(error) => print(&json!({ "ask": ask, "error": error })),
        }
    }

    fn episode(&mut self, line: &str) -> Result<Episode, String> {
        let ask: Ask = serde_json::from_str(line).map_err(|error| error.to_string())?;
        let ranges = &self.loaded.ranges;
        for name in ask.parameters.keys() {
            if !ranges.iter().any(|range| range.name == *name) {
                return Err(format!("the campaign has no parameter `{name}`"));
            }
        }
        let mut parameters = Vec::new();
        for range in ranges {
            let value = match ask.parameters.get(&range.name) {
                None => range.nominal.clone(),
                Some(value) => text(value)
                    .ok_or_else(|| format!("`{}` is not a text or a number", range.name))?,
            };
            parameters.push(Parameter { name: range.name.clone(), value });
        }
        if !meet_constraints(&self.loaded.campaign, &parameters) {
            return Err("the parameters violate a constraint of the campaign".to_owned());
        }
        let id = self.asked.last_key_value().map_or(1, |(last, _)| last + 1);
        let seed = ask.seed.unwrap_or_else(|| self.seeds.seed(id - 1));
        if seed > i32::MAX.cast_unsigned() {
            return Err(format!("`seed` is at most {}", i32::MAX));
        }
        Ok(Episode::new(id, seed, parameters))
    }

    fn answer(&self, line: EpisodeLine) -> Result<(), Failure> {
        let Some((ask, episode)) = self.asked.get(&line.episode) else { return Ok(()) };
        let mut document = json!(episode);
        if let (Value::Object(document), Value::Object(result)) = (&mut document, json!(line)) {
            document.remove("id");
            document.insert("ask".to_owned(), json!(ask));
            document.extend(result);
        }
        print(&document)
    }
}

fn text(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => match number.as_i64() {
            Some(number) => Some(number.to_string()),
            None => number.as_f64().and_then(value_of),
        },
        _ => None,
    }
}

fn print(document: &Value) -> Result<(), Failure> {
    terminal::stdout(|out| writeln!(out, "{document}").and_then(|()| out.flush()))
}
