//! Filters of the tests of the history.

use std::sync::Arc;

use rtf_history::TestAttributes;
use rtf_plan::select::FilterMatch;
use rtf_plan::select::filter::{Filter, FilterSubject, Subject};
use rtf_plan::suite::{SourceMap, SourceText};

use crate::diagnostics;
use crate::error::Failure;

/// The filters of the command line.
#[derive(Debug)]
pub struct TestFilter(Vec<Filter>);

impl TestFilter {
    /// Parses filters; prints every mistake.
    pub fn parse(filters: &[String]) -> Result<Self, Failure> {
        let (mut parsed, mut problems) = (Vec::new(), Vec::new());
        let mut sources = SourceMap::default();
        for text in filters {
            let source = SourceText::new("--filter", text);
            match rtf_plan::select::parse(&source) {
                Ok(filter) if filter.has_cases() => {
                    let error = "the history cannot be filtered by `case(…)`";
                    return Err(Failure::input(error).hint("name the case: `SUITE/TEST::CASE`"));
                }
                Ok(filter) => parsed.push(filter),
                Err(problem) => problems.push(*problem),
            }
            sources.add(Arc::new(source));
        }
        if problems.is_empty() {
            return Ok(Self(parsed));
        }
        diagnostics::print(&problems, &sources)?;
        Err(Failure::printed())
    }

    /// Parses one filter.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse_one(text: &str) -> Result<Self, String> {
        match rtf_plan::select::parse(&SourceText::new("filter", text)) {
            Ok(filter) if filter.has_cases() => {
                Err("the history cannot be filtered by `case(…)`".to_owned())
            }
            Ok(filter) => Ok(Self(vec![filter])),
            Err(problem) => Err(problem.message),
        }
    }

    /// Whether any filter matches the test, or there is none.
    pub fn matches(&self, test: &TestAttributes) -> bool {
        let subject = StoredTest(test);
        let matches = |filter: &Filter| filter.apply(&subject) != FilterMatch::None;
        self.0.is_empty() || self.0.iter().any(matches)
    }
}

/// A test of the history as the subject of a filter.
struct StoredTest<'a>(&'a TestAttributes);

impl FilterSubject for StoredTest<'_> {
    fn visit_values(&self, subject: Subject, visit: &mut dyn FnMut(&str)) {
        let test = self.0;
        match subject {
            Subject::Tag => test.tags.iter().for_each(|tag| visit(tag)),
            Subject::Type => visit(&test.plugin_type),
            Subject::Suite => visit(&test.identity.suite),
            Subject::Name => visit(&test.identity.test),
            Subject::File => visit(&test.identity.suite_file),
            Subject::Param => test.parameters.iter().for_each(|(name, value)| {
                visit(name);
                visit(&format!("{name}={value}"));
            }),
        }
    }
}
