//! Episodes that arrive on standard input while their suite runs: `rtf run --episodes -`.

use std::io::{self, BufRead, BufReader, Stdin};
use std::sync::Arc;

use rtf_engine::run::Control;
use rtf_model::Episode;

use crate::control::ControlChannels;
use crate::error::Failure;

/// The episodes after the first one.
#[derive(Debug)]
pub struct EpisodeStream {
    input: BufReader<Stdin>,
    /// How many lines were read.
    lines: usize,
    /// The names of the parameters, which are those of the first episode.
    names: Vec<String>,
}

impl EpisodeStream {
    /// Waits for the first episode: the suite is planned with its parameters.
    pub fn open() -> Result<(Episode, Self), Failure> {
        let input = BufReader::new(io::stdin());
        let mut stream = Self { input, lines: 0, names: Vec::new() };
        match stream.read() {
            Ok(Some(first)) => {
                stream.names = names(&first);
                Ok((first, stream))
            }
            Ok(None) => Err(Failure::input("standard input has no episode")),
            Err(problem) => Err(Failure::input(problem).hint("each line is an episode, as JSON")),
        }
    }

    /// Passes the further episodes to a run, in a thread that ends with the process.
    pub fn start(mut self, control: Arc<ControlChannels>) -> io::Result<()> {
        let pass = move || {
            loop {
                let next = self.read().and_then(|next| next.map(|it| self.check(it)).transpose());
                let (request, is_last) = match next {
                    Ok(Some(episode)) => (Control::Episode(episode), false),
                    Ok(None) => (Control::EndOfEpisodes, true),
                    Err(problem) => return control.stop(problem),
                };
                control.controls.send_modify(|controls| controls.push(request));
                if is_last {
                    return;
                }
            }
        };
        std::thread::Builder::new().name("episodes".to_owned()).spawn(pass).map(drop)
    }

    /// The next episode; `None` at the end.
    fn read(&mut self) -> Result<Option<Episode>, String> {
        let mut line = String::new();
        let read = self.input.read_line(&mut line);
        self.lines += 1;
        match read {
            Ok(0) => Ok(None),
            Ok(_) => serde_json::from_str(&line).map(Some).map_err(|error| self.problem(&error)),
            Err(error) => Err(self.problem(&error)),
        }
    }

    fn check(&self, episode: Episode) -> Result<Episode, String> {
        if names(&episode) == self.names {
            return Ok(episode);
        }
        Err(self.problem(&format!("its parameters are not {}", self.names.join(", "))))
    }

    fn problem(&self, problem: &dyn std::fmt::Display) -> String {
        format!("line {} of standard input is not an episode: {problem}", self.lines)
    }
}

fn names(episode: &Episode) -> Vec<String> {
    episode.parameters.iter().map(|parameter| parameter.name.clone()).collect()
}
