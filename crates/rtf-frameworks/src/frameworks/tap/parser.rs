//! TAP 12 to 14, line by line: subtests in both styles, plans, diagnostics.

use std::collections::HashSet;

use super::line::{Plan, TapLine, TestPoint};

/// The name of a subtest without a comment and a test line.
const UNNAMED: &str = "unnamed subtest";

/// Part of a TAP stream.
#[derive(Clone, Debug, PartialEq)]
pub enum TapEvent {
    /// A subtest begins.
    Opened(String),
    /// A test line that has no subtest.
    Point(ReportedPoint),
    /// The test line of the subtest that was opened last.
    Closed(ReportedPoint),
    /// The stream violates the protocol, in the innermost open subtest.
    Problem(String),
    /// The whole stream is skipped, with the reason.
    SkippedAll(String),
    /// `Bail out!`, with the reason.
    BailOut(String),
    /// The line that was just read is not part of the report.
    Output,
}

/// A test line with its diagnostics.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReportedPoint {
    pub point: TestPoint,
    /// Its position in its stream, from 1.
    pub position: u64,
    /// The lines of its YAML block.
    pub yaml: Vec<String>,
    /// The comments after it, if it is `not ok`, without `#`.
    pub comments: Vec<String>,
}

/// A stream: that of the program, or of a subtest.
#[derive(Debug, Default)]
struct Stream {
    indentation: usize,
    plan: Option<Plan>,
    /// The plan followed test lines.
    is_plan_at_end: bool,
    seen: u64,
    numbers: HashSet<u64>,
    /// The name in a comment before a subtest.
    next_name: Option<String>,
    /// The last test line, whose diagnostics may follow.
    pending: Option<Pending>,
    /// The subtest before the next test line.
    ended: Option<Subtest>,
    /// Its test line was before it: `ok 1 - name {`.
    owner: Option<ReportedPoint>,
    /// The events of a subtest whose name follows it.
    held: Option<Vec<TapEvent>>,
}

#[derive(Debug)]
struct Pending {
    reported: ReportedPoint,
    subtest: Option<Subtest>,
    accepts_comments: bool,
}

/// A subtest that has ended, and whose test line is missing so far.
#[derive(Debug)]
struct Subtest {
    /// Its events, if its name was not known.
    held: Option<Vec<TapEvent>>,
}

#[derive(Debug)]
struct Yaml {
    indentation: usize,
    lines: Vec<String>,
}

#[derive(Debug)]
pub struct TapParser {
    streams: Vec<Stream>,
    yaml: Option<Yaml>,
    is_strict: bool,
    has_bailed_out: bool,
    events: Vec<TapEvent>,
}

impl Default for TapParser {
    fn default() -> Self {
        Self {
            streams: vec![Stream::default()],
            yaml: None,
            is_strict: false,
            has_bailed_out: false,
            events: Vec::new(),
        }
    }
}

impl TapParser {
    /// Reads a line without its line end, and returns the events that are complete.
    pub fn line(&mut self, line: &str) -> Vec<TapEvent> {
        let text = line.trim_start_matches(' ');
        let indentation = line.len() - text.len();
        if !self.read_yaml(line, indentation) {
            self.read(line, indentation, TapLine::parse(text.trim_end()));
        }
        std::mem::take(&mut self.events)
    }

    /// The stream has ended. `is_complete`: the program was not killed.
    pub fn finish(&mut self, is_complete: bool) -> Vec<TapEvent> {
        if let Some(yaml) = self.yaml.take() {
            self.attach(yaml.lines);
            if is_complete {
                self.problem("the last YAML block has no end (`...`)");
            }
        }
        let checks = is_complete && !self.has_bailed_out;
        while self.streams.len() > 1 {
            self.close(checks);
            self.flush_subtest(checks);
        }
        self.flush();
        self.flush_subtest(checks);
        if checks {
            self.check_plan();
        }
        std::mem::take(&mut self.events)
    }

    /// Whether the stream has a test line or a plan.
    pub fn has_tap(&self) -> bool {
        let top = &self.streams[0];
        top.seen > 0 || top.plan.is_some() || self.streams.len() > 1 || self.has_bailed_out
    }

    /// Reads a line of a YAML block, or the first line of one.
    fn read_yaml(&mut self, line: &str, indentation: usize) -> bool {
        let Some(yaml) = &mut self.yaml else {
            let is_start = line.trim() == "---" && indentation > self.top().indentation;
            if is_start && self.top().pending.is_some() {
                self.yaml = Some(Yaml { indentation, lines: Vec::new() });
                return true;
            }
            return false;
        };
        if line.trim_end() == format!("{:1$}...", "", yaml.indentation) {
            let lines = std::mem::take(&mut yaml.lines);
            self.yaml = None;
            self.attach(lines);
        } else {
            yaml.lines.push(line.get(yaml.indentation..).unwrap_or(line.trim_start()).to_owned());
        }
        true
    }

    fn attach(&mut self, lines: Vec<String>) {
        if let Some(pending) = &mut self.top().pending {
            pending.reported.yaml.extend(lines);
            pending.accepts_comments = false;
        }
    }

    fn read(&mut self, line: &str, indentation: usize, kind: TapLine) {
        match kind {
            TapLine::Comment(comment) => {
                if let Some(pending) = &mut self.top().pending
                    && pending.accepts_comments
                {
                    pending.reported.comments.push(comment);
                }
                self.output();
            }
            TapLine::Other => {
                if let Some(pending) = &mut self.top().pending {
                    pending.accepts_comments &= line.is_empty();
                }
                if self.is_strict && !line.trim().is_empty() {
                    self.problem(&format!(
                        "a line is not TAP, which `pragma +strict` forbids: {line}"
                    ));
                }
                self.output();
            }
            TapLine::BlockEnd if !self.ends_block(indentation) => self.output(),
            _ if self.has_bailed_out => self.output(),
            kind => {
                self.enter(indentation);
                self.read_structure(kind);
            }
        }
    }

    fn ends_block(&self, indentation: usize) -> bool {
        self.streams.len() > 1
            && self.streams.iter().any(|it| it.owner.is_some() && it.indentation == indentation)
    }

    /// Finds the stream of a line with this indentation: closes inner ones, or opens one.
    fn enter(&mut self, indentation: usize) {
        while self.streams.len() > 1 && indentation < self.top().indentation {
            self.close(true);
        }
        if indentation > self.top().indentation {
            self.open(indentation);
        }
    }

    fn open(&mut self, indentation: usize) {
        self.flush_subtest(true);
        let outer = self.top();
        if outer.pending.as_ref().is_some_and(|pending| pending.reported.point.opens_block) {
            outer.owner = outer.pending.take().map(|pending| pending.reported);
        } else {
            self.flush();
        }
        let outer = self.top();
        let owner = outer.owner.as_ref().map(|owner| owner.point.description.clone());
        let name = owner.or(outer.next_name.take());
        let held = if name.is_none() { Some(Vec::new()) } else { None };
        if let Some(name) = name {
            self.emit(TapEvent::Opened(name));
        }
        self.streams.push(Stream { indentation, held, ..Stream::default() });
    }

    /// Closes the innermost subtest.
    fn close(&mut self, checks: bool) {
        self.flush();
        self.flush_subtest(checks);
        if checks {
            self.check_plan();
        }
        if let Some(closed) = self.streams.pop() {
            self.top().ended = Some(Subtest { held: closed.held });
        }
    }

    fn read_structure(&mut self, kind: TapLine) {
        // Everything but a test line follows the diagnostics of the previous one.
        self.flush();
        match kind {
            TapLine::Point(point) => self.read_point(point),
            TapLine::Plan(plan) => self.read_plan(plan),
            TapLine::SubtestName(name) => {
                self.flush_subtest(true);
                self.top().next_name = Some(name);
            }
            TapLine::Pragma(pragmas) => {
                for pragma in pragmas {
                    match pragma.as_str() {
                        "+strict" => self.is_strict = true,
                        "-strict" => self.is_strict = false,
                        _ => {}
                    }
                }
            }
            TapLine::BailOut(reason) => {
                self.has_bailed_out = true;
                self.emit(TapEvent::BailOut(reason));
            }
            TapLine::BlockEnd => self.end_block(),
            TapLine::Version | TapLine::Comment(_) | TapLine::Other => {}
        }
    }

    fn read_point(&mut self, point: TestPoint) {
        let stream = self.top();
        stream.seen += 1;
        stream.next_name = None;
        let position = stream.seen;
        let is_new = point.number.is_none_or(|number| stream.numbers.insert(number));
        let limit = stream.plan.as_ref().map(|plan| plan.count);
        let is_late = stream.is_plan_at_end;
        let subtest = stream.ended.take();
        let number = point.number.unwrap_or(position);
        let reported = ReportedPoint { position, point, ..ReportedPoint::default() };
        let accepts_comments = !reported.point.ok;
        stream.pending = Some(Pending { reported, subtest, accepts_comments });
        if !is_new {
            self.problem(&format!("the test number {number} is used twice"));
        }
        if is_late {
            self.problem(&format!("test {number} follows the plan, which is at the end"));
        } else if let Some(limit) = limit
            && number > limit
        {
            self.problem(&format!("test {number} is not in the plan, 1..{limit}"));
        }
    }

    fn read_plan(&mut self, plan: Plan) {
        self.flush_subtest(true);
        let is_top = self.streams.len() == 1;
        let stream = self.top();
        stream.is_plan_at_end = stream.seen > 0;
        if stream.plan.is_some() {
            return self.problem("there is a second plan");
        }
        let skip_reason = plan.skip_reason.clone();
        stream.plan = Some(plan);
        if let (Some(reason), true) = (skip_reason, is_top) {
            self.emit(TapEvent::SkippedAll(reason));
        }
    }

    /// `}`: the test line of the subtest was before it.
    fn end_block(&mut self) {
        if let Some(mut owner) = self.top().owner.take() {
            owner.point.opens_block = false;
            let subtest = self.top().ended.take();
            let pending = Pending { reported: owner, subtest, accepts_comments: false };
            self.top().pending = Some(pending);
        }
    }

    /// Emits the last test line.
    fn flush(&mut self) {
        let Some(pending) = self.top().pending.take() else { return };
        let Pending { mut reported, subtest, .. } = pending;
        let Some(subtest) = subtest else {
            if reported.point.opens_block {
                reported.point.opens_block = false;
                reported.point.description += " {";
            }
            return self.emit(TapEvent::Point(reported));
        };
        if let Some(held) = subtest.held {
            self.emit(TapEvent::Opened(reported.point.description.clone()));
            for event in held {
                self.emit(event);
            }
        }
        self.emit(TapEvent::Closed(reported));
    }

    /// Emits a subtest that has no test line.
    fn flush_subtest(&mut self, checks: bool) {
        let owner = self.top().owner.take();
        let Some(subtest) = self.top().ended.take() else { return };
        if let Some(held) = subtest.held {
            self.emit(TapEvent::Opened(UNNAMED.to_owned()));
            for event in held {
                self.emit(event);
            }
        }
        if checks {
            self.problem(match owner {
                Some(_) => "the subtest has no end (`}`)",
                None => "the subtest has no test line of its own",
            });
            self.emit(TapEvent::Closed(ReportedPoint::default()));
        }
    }

    fn check_plan(&mut self) {
        let stream = self.top();
        let (seen, plan) = (stream.seen, stream.plan.as_ref().map(|plan| plan.count));
        match plan {
            None if seen == 0 && self.streams.len() == 1 => {}
            None => self.problem("there is no plan (`1..N`)"),
            Some(count) if count != seen => {
                self.problem(&format!("{seen} of {count} planned tests were reported"));
            }
            Some(_) => {}
        }
    }

    fn output(&mut self) {
        self.events.push(TapEvent::Output);
    }

    fn problem(&mut self, text: &str) {
        self.emit(TapEvent::Problem(text.to_owned()));
    }

    /// Reports an event, or holds it until the name of its subtest is known.
    fn emit(&mut self, event: TapEvent) {
        let held = self.streams.iter_mut().rev().find_map(|stream| stream.held.as_mut());
        held.unwrap_or(&mut self.events).push(event);
    }

    fn top(&mut self) -> &mut Stream {
        if self.streams.is_empty() {
            self.streams.push(Stream::default());
        }
        let last = self.streams.len() - 1;
        &mut self.streams[last]
    }
}

#[cfg(test)]
#[path = "parser_tests.rs"]
mod tests;
