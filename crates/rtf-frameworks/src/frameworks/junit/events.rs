//! The events of Open Test Reporting, from XML that arrives in pieces.

use crate::framework::Garbage;
use crate::xml_stream::{XmlEvent, XmlStream};

/// The start of a test, or of a container of tests.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Started {
    /// Its number in this stream, and that of its container.
    pub id: String,
    pub parent: String,
    pub display_name: String,
    /// Its name in reports for JUnit 4.
    pub legacy_name: String,
    /// Its id, which selects it.
    pub unique_id: String,
    pub is_test: bool,
    pub tags: Vec<String>,
    /// The class that contains its method, or which it is.
    pub class: Option<String>,
    pub method: Option<String>,
}

/// The end of a test or container.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Finished {
    pub id: String,
    /// `SUCCESSFUL`, `FAILED`, `ABORTED` or `SKIPPED`.
    pub status: String,
    /// Why it was skipped.
    pub reason: String,
    /// The stack trace of the exception that ended it.
    pub stack_trace: String,
    /// Whether that is an assertion's.
    pub is_assertion: bool,
}

/// Something that a test reported about itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Attachment {
    Entry { key: String, value: String },
    File { path: String, media_type: String },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum TestEvent {
    Started(Started),
    Reported { id: String, attachment: Attachment },
    Finished(Finished),
}

/// A parser of events. Elements are known by their names without namespaces.
#[derive(Debug, Default)]
pub(super) struct TestEvents {
    xml: XmlStream,
    started: Started,
    finished: Finished,
    /// The test that an event `reported` is about.
    reported: String,
    key: String,
}

impl TestEvents {
    pub fn feed(&mut self, bytes: &[u8]) -> Result<Vec<TestEvent>, Garbage> {
        let (mut xml, mut events) = (Vec::new(), Vec::new());
        self.xml.feed(bytes, &mut xml)?;
        for event in xml {
            match event {
                XmlEvent::Start { name, attributes } => {
                    let get = |name: &str| attributes.get(name).to_owned();
                    self.start(local(&name), &get, &mut events);
                }
                XmlEvent::End { name, text } => self.end(local(&name), text, &mut events),
            }
        }
        Ok(events)
    }

    /// Whether the document has ended.
    pub fn is_complete(&self) -> bool {
        self.xml.is_complete()
    }

    fn start(&mut self, name: &str, get: &dyn Fn(&str) -> String, events: &mut Vec<TestEvent>) {
        match name {
            "started" => {
                let (id, parent, display_name) = (get("id"), get("parentId"), get("name"));
                self.started = Started { id, parent, display_name, ..Started::default() };
            }
            "finished" => self.finished = Finished { id: get("id"), ..Finished::default() },
            "reported" => self.reported = get("id"),
            "methodSource" => {
                self.started.class = Some(get("className"));
                self.started.method = Some(get("methodName"));
            }
            "classSource" => self.started.class = Some(get("className")),
            "result" => self.finished.status = get("status"),
            "throwable" => self.finished.is_assertion = get("assertionError") == "true",
            "entry" => self.key = get("key"),
            "file" => {
                let attachment =
                    Attachment::File { path: get("path"), media_type: get("mediaType") };
                events.push(TestEvent::Reported { id: self.reported.clone(), attachment });
            }
            _ => {}
        }
    }

    fn end(&mut self, name: &str, text: String, events: &mut Vec<TestEvent>) {
        match name {
            "started" => events.push(TestEvent::Started(std::mem::take(&mut self.started))),
            "finished" => events.push(TestEvent::Finished(std::mem::take(&mut self.finished))),
            "uniqueId" => self.started.unique_id = text,
            "legacyReportingName" => self.started.legacy_name = text,
            "type" => self.started.is_test = text == "TEST",
            "tag" => self.started.tags.push(text),
            "reason" => self.finished.reason = text,
            "throwable" => self.finished.stack_trace = text,
            "entry" => {
                let attachment =
                    Attachment::Entry { key: std::mem::take(&mut self.key), value: text };
                events.push(TestEvent::Reported { id: self.reported.clone(), attachment });
            }
            _ => {}
        }
    }
}

fn local(name: &str) -> &str {
    name.rsplit_once(':').map_or(name, |(_, local)| local)
}
